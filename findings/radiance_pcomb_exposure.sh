#!/usr/bin/env bash
# Radiance (pcomb): a copy of a picture with EXPOSURE=4 is four times as bright as the picture.
#
# Expected: `pcomb -s 1 sky.hdr` is the sky: its radiance is pixel / EXPOSURE, as for pvalue, pfilt, rtrace and other readers.
# Found:    pixels are copied and EXPOSURE is not: it stands indented in the new header, where it does not count. A sum of
#           two pictures of one radiance and different exposures is wrong by as much. `-o` before each picture helps.
#           pcompos, protate and pfilt keep the radiance.
# Tried:    pyradiance 1.3.1 of PyPI (Radiance 6.0a), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyradiance==1.3.1
cat >copy.py <<'PYTHON'
import os
import subprocess

import pyradiance

os.environ["PATH"] = os.path.join(os.path.dirname(pyradiance.__file__), "bin") + os.pathsep + os.environ["PATH"]


def run(*command, data=b""):
    return subprocess.run(command, input=data, capture_output=True, check=True).stdout


def radiance(picture):
    return float(run("pvalue", "-h", "-H", "-d", "-b", "-o", data=picture).split()[0])


sky = b"#?RADIANCE\nEXPOSURE=4\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + bytes([128, 128, 128, 129]) * 128
with open("sky.hdr", "wb") as file:
    file.write(sky)
found = {"sky.hdr": radiance(sky), "pcomb": radiance(run("pcomb", "-s", "1", "sky.hdr")),
         "pcomb -o": radiance(run("pcomb", "-o", "-s", "1", "sky.hdr")), "protate": radiance(run("protate", "sky.hdr")),
         "pcompos": radiance(run("pcompos", "sky.hdr", "0", "0")), "pfilt": radiance(run("pfilt", "-1", "-x", "8", "-y", "4", "sky.hdr"))}
print("found:", found)
assert abs(found["pcomb"] / found["sky.hdr"] - 4) < 0.02
assert all(abs(found[name] / found["sky.hdr"] - 1) < 0.02 for name in ("pcomb -o", "protate", "pcompos", "pfilt"))
PYTHON
venv/bin/python copy.py
