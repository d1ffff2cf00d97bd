#!/usr/bin/env bash
# OpenImageIO: whole numbers of an .exr are read as floats that are nearly 0.
#
# Expected: a channel of type UINT that holds 3, a count of samples or an object's number, is 3.0 as a float, as in Mitsuba.
# Found:    7e-10: it is divided by 2^32 - 1, as bytes of a PNG are by 255. A picture of whole numbers is black, and a mask
#           of 0 and 1 has no 1. read(format=UINT) keeps them.
# Tried:    OpenImageIO 3.2.2.0, OpenEXR 3.5.3, mitsuba 3.9.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 OpenEXR==3.5.3 mitsuba==3.9.1
venv/bin/python - <<'PYTHON'
import numpy as np
import OpenEXR

counts = np.full((4, 8), 3, np.uint32)
OpenEXR.File({"type": OpenEXR.scanlineimage}, {name: counts for name in "RGB"}).write("counts.exr")
PYTHON
cat >read.py <<'PYTHON'
import mitsuba
import numpy as np
import OpenImageIO as oiio

mitsuba.set_variant("scalar_rgb")

picture = oiio.ImageInput.open("counts.exr")
found = {"OpenImageIO": float(oiio.ImageBuf("counts.exr").get_pixels(oiio.FLOAT)[0, 0, 0]),
         "as UINT": int(picture.read_image(oiio.UINT)[0, 0, 0]), "Mitsuba": float(np.array(mitsuba.Bitmap("counts.exr").convert(component_format=mitsuba.Struct.Type.Float32))[0, 0, 0])}
print("found:", found, "for 3")
assert abs(found["OpenImageIO"] * (2**32 - 1) - 3) < 1e-3 and found["as UINT"] == 3 and found["Mitsuba"] == 3
PYTHON
venv/bin/python read.py
