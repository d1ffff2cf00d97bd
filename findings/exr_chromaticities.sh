#!/usr/bin/env bash
# OpenEXR: one reader in four looks at the primaries that a file names.
#
# Expected: `chromaticities` says what red, green and blue of the file are; pure green of ACES2065-1 (AP0) is no colour of
#           Rec. 709, so that a reader who hands out linear Rec. 709 converts it.
# Found:    Mitsuba converts: -1.12, 1.37, -0.15. three.js says srgb-linear, hdrify linear-rec709, OpenImageIO nothing, and all
#           have 0, 1, 0. A panorama in AP0 or ACEScg gets too pale in them, and its blue sky turns.
# Tried:    OpenEXR 3.5.3, mitsuba 3.9.1, OpenImageIO 3.2.2.0 of PyPI, Python 3.11; three 0.187.0, hdrify 1.2.1 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 hdrify@1.2.1
python3.11 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 mitsuba==3.9.1 OpenImageIO==3.2.2.0 numpy==2.4.6
cat >green.py <<'PYTHON'
import mitsuba as mi
import numpy as np
import OpenEXR
import OpenImageIO as oiio

picture = np.zeros((4, 8, 3), np.float32)
picture[..., 1] = 1
header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage,
          "chromaticities": (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)}
OpenEXR.File(header, {"RGB": picture}).write("green.exr")
mi.set_variant("scalar_rgb")
mitsuba = np.array(mi.Bitmap("green.exr"))[0, 0].tolist()
image = oiio.ImageBuf("green.exr")
pixel, space = image.get_pixels(oiio.FLOAT)[0, 0].tolist(), image.spec().get_string_attribute("oiio:ColorSpace")
print("found: Mitsuba", mitsuba, "- OpenImageIO", pixel, repr(space))
assert np.allclose(mitsuba, [-1.119, 1.366, -0.149], atol=0.01)
assert pixel == [0, 1, 0] and space in ("", "scene_linear", "lin_rec709_scene")
PYTHON
cat >green.mjs <<'JAVASCRIPT'
import { readFileSync } from 'node:fs';
import { readExr } from 'hdrify';
import { FloatType } from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';

const bytes = new Uint8Array(readFileSync('green.exr'));
const three = new EXRLoader().setDataType(FloatType).parse(bytes.buffer);
const hdrify = readExr(bytes);
const pixel = ({ data }) => Array.from(data.slice(0, 3)).join();
console.log('found: three.js', pixel(three), three.colorSpace, '- hdrify', pixel(hdrify), hdrify.linearColorSpace);
if (pixel(three) !== '0,1,0' || pixel(hdrify) !== '0,1,0') process.exit(1);
if (three.colorSpace !== 'srgb-linear' || hdrify.linearColorSpace !== 'linear-rec709') process.exit(1);
JAVASCRIPT
venv/bin/python green.py
node green.mjs
