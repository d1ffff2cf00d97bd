#!/usr/bin/env bash
# trimesh: the base colours of glTF materials become bytes of linear light.
#
# Expected: baseColorFactor is kept, a float of linear light.
# Found:    it is rounded to 1/255. Of linear light that is coarse in the dark: 0.0015 becomes 0, 0.002 twice as bright
#           and 0.01 becomes 0.0118. The next export writes that. Black rubber, coal and dark paint change by tens of
#           per cent, while roughness and metallic stay floats.
# Tried:    trimesh 5.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q trimesh==5.2.0
cat >colors.py <<'PYTHON'
import base64
import json
import struct

import trimesh

corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def round_trip(color):
    """The base colour of a triangle's material after trimesh read and wrote it."""
    with open("in.gltf", "w") as file:
        json.dump({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [color] * 3 + [1], "roughnessFactor": 0.123}}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                           "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,"
                         + base64.b64encode(corners).decode()}]}, file)
    trimesh.load("in.gltf").export("out.glb")
    with open("out.glb", "rb") as file:
        data = file.read()
    (length,) = struct.unpack_from("<I", data, 12)
    pbr = json.loads(data[20:20 + length])["materials"][0]["pbrMetallicRoughness"]
    assert pbr["roughnessFactor"] == 0.123
    return pbr["baseColorFactor"][0]


found = {color: round_trip(color) for color in (0.0015, 0.002, 0.01)}
print("found:", found)
assert found[0.0015] == 0 and abs(found[0.002] - 1 / 255) < 1e-6 and abs(found[0.01] - 3 / 255) < 1e-6
PYTHON
venv/bin/python colors.py
