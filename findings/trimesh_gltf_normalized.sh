#!/usr/bin/env bash
# trimesh (glTF): quantized meshes are 32,767 times too large.
#
# Expected: numbers of an accessor with `normalized` stand for -1 to 1 or 0 to 1. KHR_mesh_quantization allows that for positions,
#           normals and uvs, and gltf-transform and gltfpack write it. A reader that does not know a required extension refuses.
# Found:    the whole numbers are taken as they are: a square of 1 x 1 has sides of 32,767, and uvs go to 255 and wrap around
#           where v is turned over. Nothing is said.
# Tried:    trimesh 5.2.0, Python 3.11. gltf-validator 2.0.0-dev.3.10 finds no fault in the file.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q trimesh==5.2.0 pillow==13.0.0
cat >square.py <<'PYTHON'
import base64
import json
import struct

import trimesh

CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
# A square of 1 x 1: shorts of -32767..32767 stand for -1..1, bytes of 0..255 for uvs of 0..1. Elements take multiples of 4.
positions = b"".join(struct.pack("<4h", 32767 * x, 32767 * y, 0, 0) for x, y in CORNERS)
uvs = b"".join(struct.pack("<4B", 255 * x, 255 * y, 0, 0) for x, y in CORNERS)
indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
data = positions + uvs + indices
views = [(0, 32, 8, 34962), (32, 16, 4, 34962), (48, 12, None, 34963)]
square = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
    "materials": [{}],
    "accessors": [
        {"bufferView": 0, "componentType": 5122, "normalized": True, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [32767, 32767, 0]},
        {"bufferView": 1, "componentType": 5121, "normalized": True, "count": 4, "type": "VEC2"},
        {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size, "target": target, **({"byteStride": stride} if stride else {})}
                    for at, size, stride, target in views],
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
with open("square.gltf", "w") as file:
    json.dump(square, file)
(mesh,) = trimesh.load("square.gltf").geometry.values()
size = (mesh.bounds[1] - mesh.bounds[0]).tolist()
print("found: size of a square of 1 x 1:", size, "and its uvs:", mesh.visual.uv.tolist())
assert size == [32767, 32767, 0]
assert mesh.visual.uv.max() == 255
print("held")
PYTHON
venv/bin/python square.py
