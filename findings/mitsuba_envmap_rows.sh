#!/usr/bin/env bash
# Mitsuba (envmap): rows of a lat-long stand on its borders, columns do not.
#
# Expected: a pixel's light comes from the middle of its patch, row i of H at (i + 1/2) / H of the way down, column j of W at
#           (j + 1/2) / W; or, as OpenEXR has it, from the borders in both ways.
# Found:    columns are at the middle, rows at i / (H - 1): the first row is the zenith itself, the last one the nadir, and a
#           lamp in the second of 8 rows is 26 degrees below the zenith, not 34. In 1,024 rows it is 0.09 degrees.
# Tried:    mitsuba 3.9.1 of PyPI (scalar_rgb), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q mitsuba==3.9.1 numpy==2.4.6
cat >rows.py <<'PYTHON'
import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")
height, width = 8, 16


def brightest(picture, directions):
    """Which of the directions to a sky, from the scene, is the brightest."""
    sky = mitsuba.load_dict({"type": "envmap", "bitmap": mitsuba.Bitmap(picture.astype(np.float32))})
    point = mitsuba.SurfaceInteraction3f()
    seen = []
    for x, y, z in directions:
        point.wi = mitsuba.Vector3f(-x, -y, -z)
        seen.append(float(sky.eval(point)[0]))
    return int(np.argmax(seen))


def lit(rows=slice(None), columns=slice(None)):
    picture = np.zeros((height, width, 3))
    picture[rows, columns] = 1
    return picture


down, around = np.linspace(0, 1, 1001), np.linspace(0, 1, 1001)[:-1]
meridian = [(np.sin(v * np.pi) * np.sin(0.1), np.cos(v * np.pi), -np.sin(v * np.pi) * np.cos(0.1)) for v in down]
equator = [(np.sin(u * 2 * np.pi), 0, -np.cos(u * 2 * np.pi)) for u in around]
rows = [down[brightest(lit(rows=row), meridian)] for row in range(height)]
columns = [around[brightest(lit(columns=column), equator)] for column in range(width)]
print("found: rows at", np.round(rows, 3), "columns at", np.round(columns, 3))
assert np.allclose(rows, np.arange(height) / (height - 1), atol=2e-3)
assert np.allclose(columns, (np.arange(width) + 0.5) / width, atol=2e-3)
PYTHON
venv/bin/python rows.py
