#!/usr/bin/env bash
# bpy (glTF importer): light that was baked into a file's vertices is cut off at 1 and becomes bytes.
#
# Expected: COLOR_0 of floats becomes a colour attribute of floats, which Blender has: 50 stays 50.
# Found:    an attribute of bytes. 50 and 2 become 1, so a bright floor and its lamp are alike. The bytes are sRGB, so the dark
#           is kept to some per cent: 0.001 becomes 0.00091. What Blender exports then has floats again.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11. bpy 5.2.3 does the same.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >light.py <<'PYTHON'
import base64
import json
import struct

import bpy

light = (0.001, 2.0, 50.0)
data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<9f", *(x for x in light for _ in range(3)))
with open("in.gltf", "w") as file:
    json.dump({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "material": 0}]}],
        "materials": [{"extensions": {"KHR_materials_unlit": {}}}], "extensionsUsed": ["KHR_materials_unlit"],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36}],
        "buffers": [{"byteLength": 72, "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}, file)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath="in.gltf")
(mesh,) = bpy.data.meshes
(colors,) = mesh.color_attributes
found = sorted(each.color[0] for each in colors.data)
print("found:", colors.data_type, [round(x, 5) for x in found], "for", light)
assert colors.data_type == "BYTE_COLOR" and found[1] == found[2] == 1 and 0.0008 < found[0] < 0.00095
PYTHON
venv/bin/python light.py >log 2>&1 || { tail -20 log; exit 1; }
grep found: log
