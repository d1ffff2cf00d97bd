#!/usr/bin/env bash
# OpenImageIO: resizing or rotating a sky makes negative light around its sun.
#
# Expected: light stays light.
# Found:    the filters that resize() to half of the size and rotate() take by themselves have negative lobes. Around a
#           sun of 50,000 in a sky of 0.5 pixels become -1,487 and -6,970. resize() keeps the mean, so that the light
#           of the whole is right and the sky beside the sun is a hole. A filter such as "box" or "triangle" makes none.
# Tried:    OpenImageIO 3.2.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 numpy
cat >sky.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio

pixels = np.full((64, 128, 3), 0.5, np.float32)
pixels[20, 40] = 50000
sky = oiio.ImageBuf(pixels)
half = oiio.ROI(0, 64, 0, 32, 0, 1, 0, 3)
small = oiio.ImageBufAlgo.resize(sky, roi=half).get_pixels("float")
plain = oiio.ImageBufAlgo.resize(sky, filtername="triangle", roi=half).get_pixels("float")
turned = oiio.ImageBufAlgo.rotate(sky, 0.1).get_pixels("float")
print("found: least of the half", small.min(), "with a triangle", plain.min(), "of the turned sky", turned.min())
print("found: mean", pixels.mean(), "of the half", small.mean())
assert small.min() < -1000 and turned.min() < -5000 and plain.min() >= 0.49
assert abs(small.mean() / pixels.mean() - 1) < 1e-3
PYTHON
venv/bin/python sky.py
