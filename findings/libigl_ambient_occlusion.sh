#!/usr/bin/env bash
# libigl: ambient_occlusion() counts directions, not light.
#
# Expected: the part of a grey sky's light that does not arrive, as bakers and renderers mean it, where a direction counts
#           with the cosine: 0.554 below a square of side 2 that hangs 1 above a floor (4 / pi / sqrt 2 * atan(1 / sqrt 2)).
# Found:    0.333, the square's solid angle over that of the hemisphere. What hangs above counts too little, what stands
#           at the horizon too much: for a wall of 10 degrees all around it is 0.174 in place of 0.030. 1 is all blocked.
# Tried:    libigl 2.6.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q libigl==2.6.3
cat >occlusion.py <<'PYTHON'
import igl
import numpy as np

floor, up = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])


def blocked(corners, triangles):
    return float(igl.ambient_occlusion(np.array(corners, float), np.array(triangles), floor, up, 200000)[0])


square = blocked([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], [[0, 1, 2], [0, 2, 3]])
angles = np.linspace(0, 2 * np.pi, 361)[:-1]
ring = [[np.cos(a), np.sin(a), z] for a in angles for z in (0, np.tan(np.radians(10)))]
strip = [[(2 * i + a) % 720, (2 * i + b) % 720, (2 * i + c) % 720] for i in range(360) for a, b, c in ((0, 2, 1), (1, 2, 3))]
wall = blocked(ring, strip)
light = 4 / np.pi / np.sqrt(2) * np.arctan(1 / np.sqrt(2)), np.sin(np.radians(10)) ** 2
print(f"found: {square:.3f} for {light[0]:.3f}, {wall:.3f} for {light[1]:.3f}")
assert abs(light[0] - 0.554) < 1e-3 and abs(square - 1 / 3) < 0.01
assert abs(light[1] - 0.030) < 1e-3 and abs(wall - np.sin(np.radians(10))) < 0.01
PYTHON
venv/bin/python occlusion.py
