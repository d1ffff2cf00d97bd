#!/usr/bin/env bash
# Open3D: what a glTF file mirrors is inside out.
#
# Expected: a node of negative scale turns the order of its corners around [glTF 2.0, 3.7.4], so that a mirrored wheel, door or
#           half of a face has its front outside, and its faces look where the normals of the file look.
# Found:    the points are mirrored and the order of the corners stays: the volume of a box is negative and normals that are
#           computed look inwards, so light falls on the wrong side. The file's own normals are turned right. trimesh turns
#           the corners.
# Tried:    open3d-cpu 0.20.0 and trimesh 5.2.0 of PyPI, Python 3.11, libusb of Debian.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
apt-get download -qq libusb-1.0-0 2>/dev/null
dpkg -x libusb-1.0-0*.deb system
python3.11 -m venv venv
venv/bin/pip install -q open3d-cpu==0.20.0 trimesh==5.2.0
cat >boxes.py <<'PYTHON'
import base64
import json

import numpy as np
import open3d
import trimesh

box = trimesh.creation.box()
corners, normals = np.float32(box.triangles.reshape(-1, 3)), np.float32(np.repeat(box.face_normals, 3, 0))
data = corners.tobytes() + normals.tobytes()


def read(scale):
    """Whether faces and normals of a box look outwards, and the volume, as trimesh has it."""
    with open("box.gltf", "w") as file:
        json.dump({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": scale}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 36, "type": "VEC3", "min": [-0.5] * 3,
                           "max": [0.5] * 3}, {"bufferView": 1, "componentType": 5126, "count": 36, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 432}, {"buffer": 0, "byteOffset": 432, "byteLength": 432}],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                         + base64.b64encode(data).decode()}]}, file)
    mesh = open3d.io.read_triangle_mesh("box.gltf")
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    given = (np.asarray(mesh.vertex_normals) * points).sum(1)
    mesh.compute_triangle_normals()
    computed = (np.asarray(mesh.triangle_normals) * points[faces].mean(1)).sum(1)
    other = trimesh.load("box.gltf").to_geometry().volume
    sides = ["outwards" if (x > 0).all() else "inwards" if (x < 0).all() else "mixed" for x in (computed, given)]
    return [*sides, round(float(other), 3)]


found = {name: read(scale) for name, scale in (("plain", [1, 1, 1]), ("mirrored", [-1, 1, 1]))}
for name, (computed, given, volume) in found.items():
    print("found:", name, "- Open3D: faces", computed, "normals of the file", given, "- trimesh: volume", volume)
assert found == {"plain": ["outwards", "outwards", 1], "mirrored": ["inwards", "outwards", 1]}
PYTHON
LD_LIBRARY_PATH=$(dirname "$(find "$PWD/system" -name 'libusb-1.0.so.0')") venv/bin/python boxes.py
