#!/usr/bin/env bash
# OpenImageIO: LogLuv TIFF, a format for light, is read as bytes that end at white.
#
# Expected: SGILOG (32 bits) and SGILOG24 hold 38 and 5 decades of light; libtiff, by which OpenImageIO reads TIFF, gives floats
#           if it is asked to. So what `ra_tiff -L` of Radiance writes has its 4 back, as the same picture as floats has.
# Found:    uint8, and 4, 2, 1 become 1, 1, 1. Nothing is said. A panorama has no sun and no lamps any more, and the rest goes
#           through a curve for the eye. Radiance reads its own light back.
# Tried:    pyradiance 1.3.1 (Radiance 6.0a), OpenImageIO 3.2.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyradiance==1.3.1 OpenImageIO==3.2.2.0 numpy==2.4.6
cat >logluv.py <<'PYTHON'
import os
import subprocess

import OpenImageIO as oiio
import pyradiance

os.environ["PATH"] = os.path.join(os.path.dirname(pyradiance.__file__), "bin") + os.pathsep + os.environ["PATH"]
with open("light.hdr", "wb") as file:
    file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + bytes([128, 64, 32, 131]) * 128)
found = {}
for option in ("-L", "-l", "-f"):
    subprocess.run(["ra_tiff", option, "light.hdr", "light.tif"], capture_output=True, check=True)
    back = subprocess.run("ra_tiff -r light.tif | pvalue -h -H -d", shell=True, capture_output=True, check=True).stdout
    image = oiio.ImageBuf("light.tif")
    found[option] = (str(image.spec().format), image.get_pixels(oiio.FLOAT)[0, 0].tolist(), [float(x) for x in back.split()[:3]])
    print("found: ra_tiff", option, "- OpenImageIO", found[option][:2], "- Radiance", found[option][2])
assert found["-L"][:2] == found["-l"][:2] == ("uint8", [1, 1, 1])
assert found["-f"][0] == "float" and abs(found["-f"][1][0] - 4) < 0.1
assert all(abs(back[0] - 4) < 0.2 for _, _, back in found.values())
PYTHON
venv/bin/python logluv.py
