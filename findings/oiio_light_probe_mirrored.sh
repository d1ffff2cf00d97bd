#!/usr/bin/env bash
# OpenImageIO (maketx --lightprobe): an angular map becomes a mirrored panorama.
#
# Expected: what is right of the middle of Debevec's light probe is right of the panorama's middle: both are seen from inside.
# Found:    a lamp 60 degrees to the right is 60 degrees to the left, so writing is mirrored, and light comes from the wrong
#           side when the picture is turned until its middle fits. The angle grows with the radius, as in Debevec's maps
#           and not in photographs of a ball, which are mirror images. Up stays up.
# Tried:    OpenImageIO 3.2.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 numpy==2.4.6
cat >probe.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio

size = 257


def panorama(right, up):
    """Where a lamp of a light probe is in the panorama, in degrees to the right of its middle and above it."""
    y, x = np.mgrid[0:size, 0:size]
    x, y = (x + 0.5) / size * 2 - 1, 1 - (y + 0.5) / size * 2
    picture = np.where((x - right / 180) ** 2 + (y - up / 180) ** 2 < 0.001, 1, 0).astype(np.float32)
    oiio.ImageBuf(np.repeat(picture[..., None], 3, 2)).write("probe.exr")
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxEnvLatlFromLightProbe, "probe.exr", "panorama.exr", oiio.ImageSpec())
    pixels = oiio.ImageBuf("panorama.exr").get_pixels(oiio.FLOAT)[..., 0]
    height, width = pixels.shape
    rows, columns = np.nonzero(pixels > 0.5)
    return (columns.mean() + 0.5) / width * 360 - 180, 90 - (rows.mean() + 0.5) / height * 180


found = {lamp: tuple(round(float(angle), 1) for angle in panorama(*lamp)) for lamp in ((60, 0), (-90, 0), (0, 45))}
print("found, degrees to the right and up:", found)
assert abs(found[60, 0][0] + 60) < 3 and abs(found[-90, 0][0] - 90) < 3
assert abs(found[0, 45][0]) < 3 and abs(found[0, 45][1] - 45) < 3
PYTHON
venv/bin/python probe.py
