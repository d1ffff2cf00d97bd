#!/usr/bin/env bash
# trimesh: the light in a glTF's vertices becomes black, or noise.
#
# Expected: COLOR_0 of floats or of 16 bits is written as it was read, or as bytes of the same colours, as trimesh does for
#           floats of a mesh without a material.
# Found:    the numbers are cast to bytes as they are. Where the mesh has a material, floats of 0.001, 0.5, 1 become 0, 0 and
#           1 of 255: baked light is black. Of 16 bits the lower byte is left, with a material or without: 40,000 of 65,535
#           becomes 64 of 255, and 10,000 becomes 16.
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


def round_trip(color, letter, has_material):
    """The first corner's COLOR_0, in 0..1, of a triangle that trimesh read and wrote."""
    kind = {"f": {"componentType": 5126}, "H": {"componentType": 5123, "normalized": True}}[letter]
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<4" + letter, *color) * 3
    primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}, **({"material": 0} if has_material else {})}
    with open("in.gltf", "w") as file:
        json.dump({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [primitive]}], "materials": [{"name": "white"}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                           "max": [1, 1, 0]}, {"bufferView": 1, "count": 3, "type": "VEC4", **kind}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": len(data) - 36}],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                         + base64.b64encode(data).decode()}]}, file)
    trimesh.load("in.gltf").export("out.glb")
    with open("out.glb", "rb") as file:
        data = file.read()
    (length,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20:20 + length])
    accessor = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    assert accessor["componentType"] == 5121 and accessor["normalized"]
    start = 28 + length + tree["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return [byte / 255 for byte in data[start:start + 4]]


floats, shorts = (0.001, 0.5, 1, 1), (10000, 40000, 65535, 65535)
found = {(name, material): round_trip(color, letter, material)
         for name, color, letter in (("floats", floats, "f"), ("16 bits", shorts, "H")) for material in (False, True)}
for (name, material), color in found.items():
    print("found:", name, "with a material:" if material else "without:", [round(x * 255) for x in color], "of 255")
assert found["floats", False] == [0, 128 / 255, 1, 1]
assert found["floats", True] == [0, 0, 1 / 255, 1 / 255]
assert found["16 bits", True] == found["16 bits", False] == [10000 % 256 / 255, 40000 % 256 / 255, 1, 1]
PYTHON
venv/bin/python colors.py
