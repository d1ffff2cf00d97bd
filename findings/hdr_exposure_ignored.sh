#!/usr/bin/env bash
# Radiance pictures: what pfilt made brighter for the eye is brighter light in other programs.
#
# Expected: EXPOSURE in the header says by how much pixels were multiplied, so that a reader who wants light divides by it:
#           `pfilt -1 -e 4` changes how a panorama looks and not what it says, as pvalue shows.
# Found:    OpenImageIO, Mitsuba and imagecodecs hand out the pixels as they stand, four times as bright. OpenImageIO has the number
#           as the attribute hdr:exposure. What any of them writes from that has no EXPOSURE, so it is lost for good.
# Tried:    pyradiance 1.3.1 (Radiance 6.0a), OpenImageIO 3.2.2.0, mitsuba 3.9.1, imagecodecs 2026.3.6 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyradiance==1.3.1 OpenImageIO==3.2.2.0 mitsuba==3.9.1 imagecodecs==2026.3.6 numpy==2.4.6
cat >exposure.py <<'PYTHON'
import os
import subprocess

import imagecodecs
import mitsuba as mi
import numpy as np
import OpenImageIO as oiio
import pyradiance

os.environ["PATH"] = os.path.join(os.path.dirname(pyradiance.__file__), "bin") + os.pathsep + os.environ["PATH"]
mi.set_variant("scalar_rgb")


def seen(path):
    """The first pixel's red of a picture, as five programs have it."""
    with open(path, "rb") as file:
        data = file.read()
    radiance = subprocess.run(["pvalue", "-h", "-H", "-d", "-o", path], capture_output=True, check=True).stdout
    image = oiio.ImageBuf(path)
    oiio.ImageBuf(path).write("copy.hdr")
    with open("copy.hdr", "rb") as file:
        copy = file.read()
    return {"Radiance": float(radiance.split()[0]), "OpenImageIO": float(image.get_pixels(oiio.FLOAT)[0, 0, 0]),
            "Mitsuba": float(np.array(mi.Bitmap(path))[0, 0, 0]), "imagecodecs": float(imagecodecs.rgbe_decode(data)[0, 0, 0]),
            "hdr:exposure": image.spec().get_float_attribute("hdr:exposure"), "EXPOSURE in a copy": b"EXPOSURE" in copy}


with open("sky.hdr", "wb") as file:
    file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + bytes([128, 128, 128, 130]) * 128)
with open("bright.hdr", "wb") as file:
    subprocess.run(["pfilt", "-1", "-e", "4", "sky.hdr"], stdout=file, check=True)
before, after = seen("sky.hdr"), seen("bright.hdr")
print("found: before", before)
print("found: after pfilt -1 -e 4", after)
assert abs(after["Radiance"] / before["Radiance"] - 1) < 0.02 and after["hdr:exposure"] == 4
assert all(abs(after[name] / before[name] - 4) < 0.05 for name in ("OpenImageIO", "Mitsuba", "imagecodecs"))
assert not after["EXPOSURE in a copy"]
PYTHON
venv/bin/python exposure.py
