#!/usr/bin/env bash
# xatlas: a mesh of millimetres, in metres, gets texture coordinates that are not numbers.
#
# Expected: an unwrap depends on the shape, not on its size or place: a ball of radius 0.003 is unwrapped like one of radius 1.
# Found:    all coordinates are NaN from radius 0.003 down, and nothing is said; at 0.01 they are fine. Far from the
#           origin, at 10,000 with radius 1, five of six triangles have no area in the atlas.
# Tried:    xatlas 0.0.11 and trimesh 5.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q xatlas==0.0.11 trimesh==5.2.0
cat >ball.py <<'PYTHON'
import numpy as np
import trimesh
import xatlas

ball = trimesh.creation.icosphere(3)


def unwrapped(radius=1.0, place=0.0):
    """(part of the coordinates that are numbers, part of the triangles with an area in the atlas)"""
    points = (np.asarray(ball.vertices) * radius + place).astype(np.float32)
    _, triangles, uv = xatlas.parametrize(points, np.asarray(ball.faces, np.uint32))
    a, b, c = uv[triangles].transpose(1, 0, 2)
    areas = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    return round(float(np.isfinite(uv).mean()), 3), round(float((np.abs(areas) > 0).mean()), 3)


small = {radius: unwrapped(radius) for radius in (1.0, 0.01, 0.003, 0.001)}
far = {place: unwrapped(place=place) for place in (100.0, 10000.0)}
print("found, numbers and triangles with an area, by radius:", small, "- by place:", far)
assert small[1.0] == small[0.01] == (1, 1) and small[0.003][0] == small[0.001][0] == 0
assert far[100.0] == (1, 1) and far[10000.0][1] < 0.5
PYTHON
venv/bin/python ball.py
