#!/usr/bin/env bash
# Open3D: a .glb that it wrote comes back empty.
#
# Expected: write_triangle_mesh() and read_triangle_mesh() agree; other readers take the file, too.
# Found:    the write says True, the read says "out of range" and gives 0 triangles. The file has no binary chunk: its buffer
#           is a data URI, as in a .gltf, which glTF allows and Open3D's reader, assimp, does not expect there. trimesh
#           reads it whole. A .gltf comes back.
# Tried:    open3d-cpu 0.20.0 and trimesh 5.2.0 of PyPI, Python 3.11, libusb of Debian.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
apt-get download -qq libusb-1.0-0 2>/dev/null
dpkg -x libusb-1.0-0*.deb system
python3.11 -m venv venv
venv/bin/pip install -q open3d-cpu==0.20.0 trimesh==5.2.0
cat >ball.py <<'PYTHON'
import json
import struct

import open3d
import trimesh

ball = open3d.geometry.TriangleMesh.create_sphere()
count = {}
for name in ("ball.glb", "ball.gltf"):
    assert open3d.io.write_triangle_mesh(name, ball)
    count[name] = len(open3d.io.read_triangle_mesh(name).triangles)
with open("ball.glb", "rb") as file:
    data = file.read()
(length,) = struct.unpack_from("<I", data, 12)
(buffer,) = json.loads(data[20:20 + length])["buffers"]
other = sum(len(mesh.faces) for mesh in trimesh.load("ball.glb").geometry.values())
print("found:", count, "of", len(ball.triangles), "- chunks end at", 20 + length, "of", len(data), "- trimesh:", other)
assert count == {"ball.glb": 0, "ball.gltf": len(ball.triangles)} and other == len(ball.triangles)
assert len(data) == 20 + length and buffer["uri"].startswith("data:")
PYTHON
LD_LIBRARY_PATH=$(dirname "$(find "$PWD/system" -name 'libusb-1.0.so.0')") venv/bin/python ball.py 2>log || { tail -20 log; exit 1; }
