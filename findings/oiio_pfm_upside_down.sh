#!/usr/bin/env bash
# OpenImageIO: a PFM that it wrote comes back upside down.
#
# Expected: what is written is what is read.
# Found:    the file has its lowest row first, as the format has it, and OpenCV reads it upright. OpenImageIO's own
#           reader gives the rows in the file's order: a lat-long has its ground above.
# Tried:    OpenImageIO 3.2.2.0 and opencv-python-headless 4.12.0.88 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 opencv-python-headless==4.12.0.88
cat >pfm.py <<'PYTHON'
import cv2
import numpy as np
import OpenImageIO as oiio

rows = np.repeat(np.arange(1, 5, dtype=np.float32)[:, None, None], 8, 1).repeat(3, 2)  # 1 above, 4 below
spec = oiio.ImageSpec(8, 4, 3, "float")
out = oiio.ImageOutput.create("rows.pfm")
out.open("rows.pfm", spec)
out.write_image(rows)
out.close()
back = oiio.ImageInput.open("rows.pfm").read_image("float")[:, 0, 0]
other = cv2.imread("rows.pfm", cv2.IMREAD_UNCHANGED)[:, 0, 0]
print("found: written 1 2 3 4; OpenImageIO reads", *back, "and OpenCV", *other)
assert list(back) == [4, 3, 2, 1] and list(other) == [1, 2, 3, 4]
PYTHON
venv/bin/python pfm.py
