#!/usr/bin/env bash
# pymeshlab (glTF): light in vertices wraps around: 2 is less than 1, and 16 bits are noise.
#
# Expected: COLOR_0 becomes MeshLab's bytes, rounded and cut off at 1, whether a file has it as floats, as 16 bits or as bytes.
# Found:    floats are taken times 255 modulo 256: 1.01 becomes 1/255, 5 becomes 0.98, so the brightest spot of a baked floor
#           is black. Of 16 bits the lower byte is left: 40,000 of 65,535 becomes 64 of 255, and 256 becomes 0. Bytes are right.
# Tried:    pymeshlab 2025.7.post1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pymeshlab==2025.7.post1
cat >colors.py <<'PYTHON'
import base64
import json
import struct

import pymeshlab


def read(color, letter):
    """What MeshLab has, of 255, for the red, green and blue of a triangle's first corner."""
    kind = {"f": {"componentType": 5126}, "H": {"componentType": 5123, "normalized": True},
            "B": {"componentType": 5121, "normalized": True}}[letter]
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<4" + letter, *color) * 3
    with open("in.gltf", "w") as file:
        json.dump({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                           "max": [1, 1, 0]}, {"bufferView": 1, "count": 3, "type": "VEC4", **kind}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": len(data) - 36}],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                         + base64.b64encode(data).decode()}]}, file)
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh("in.gltf")
    return [round(float(x) * 255) for x in meshes.current_mesh().vertex_color_matrix()[0][:3]]


found = {"floats 0.5, 1.01, 5": read((0.5, 1.01, 5, 1), "f"), "16 bits 256, 40000, 65535": read((256, 40000, 65535, 65535), "H"),
         "bytes 10, 128, 255": read((10, 128, 255, 255), "B")}
for name, values in found.items():
    print("found:", name, "become", values, "of 255")
assert list(found.values()) == [[127, 1, 251], [0, 64, 255], [10, 128, 255]]
PYTHON
venv/bin/python colors.py
