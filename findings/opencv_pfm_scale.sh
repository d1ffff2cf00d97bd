#!/usr/bin/env bash
# OpenCV: a PFM whose scale is 2 comes back half as bright, where other programs make it twice as bright.
#
# Expected: the number in the third line multiplies the samples, as in OpenImageIO, ImageMagick 6.9 and pfstools 2.2.
# Found:    OpenCV divides by it: the same file is four times as bright in OpenImageIO. Files of scale 1 or -1, which
#           OpenCV itself writes, are the same in both.
# Tried:    opencv-python-headless 4.12.0.88 and OpenImageIO 3.2.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 opencv-python-headless==4.12.0.88
cat >scale.py <<'PYTHON'
import cv2
import numpy as np
import OpenImageIO as oiio

pixels = np.full((2, 4, 3), 8, "<f4").tobytes()
for scale in ("-1.0", "-2.0"):
    name = f"scale{scale}.pfm"
    with open(name, "wb") as file:
        file.write(f"PF\n4 2\n{scale}\n".encode() + pixels)
    opencv = float(cv2.imread(name, cv2.IMREAD_UNCHANGED)[0, 0, 0])
    other = float(oiio.ImageInput.open(name).read_image("float")[0, 0, 0])
    print(f"found: samples of 8, scale {scale}: OpenCV {opencv:g}, OpenImageIO {other:g}")
    assert opencv == 8 / abs(float(scale)) and other == 8 * abs(float(scale))
PYTHON
venv/bin/python scale.py
