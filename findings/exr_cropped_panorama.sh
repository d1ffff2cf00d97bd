#!/usr/bin/env bash
# OpenEXR: a panorama whose black ground was cropped away is stretched over the whole sphere.
#
# Expected: the display window is the picture, the data window is the part that was stored: what is outside is black. Writers
#           that crop to what is not black, as compositing does, leave the picture as it is.
# Found:    three.js, hdrify and Mitsuba hand out the data window as the picture. Of a map of 16 x 8 whose upper half was stored
#           they have 16 x 4: the horizon becomes the nadir, the light doubles and a sun of 22 degrees above the horizon stands
#           45 degrees below it. Nothing is said. Who converts such a file has to put the ground back first.
# Tried:    OpenEXR 3.5.3, mitsuba 3.9.1 of PyPI, Python 3.11; three 0.187.0, hdrify 1.2.1 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 hdrify@1.2.1
python3.11 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 mitsuba==3.9.1 numpy==2.4.6
cat >sky.py <<'PYTHON'
import mitsuba as mi
import numpy as np
import OpenEXR

sky = np.ones((4, 16, 3), np.float32)
header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage,
          "dataWindow": (np.array([0, 0], np.int32), np.array([15, 3], np.int32)),
          "displayWindow": (np.array([0, 0], np.int32), np.array([15, 7], np.int32))}
OpenEXR.File(header, {"RGB": sky}).write("sky.exr")
mi.set_variant("scalar_rgb")
size = tuple(mi.Bitmap("sky.exr").size())
scene = mi.load_dict({
    "type": "scene", "sky": {"type": "envmap", "filename": "sky.exr"}, "integrator": {"type": "path"},
    "sensor": {"type": "perspective", "fov": 1, "to_world": mi.ScalarTransform4f().look_at([0, 0, 0], [0, -1, 0], [0, 0, 1]),
               "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}}}})
below = float(np.array(mi.render(scene, spp=4)).mean())
print("found: Mitsuba", size, "and light from straight below", below)
assert size == (16, 4) and abs(below - 1) < 0.01
PYTHON
cat >sky.mjs <<'JAVASCRIPT'
import { readFileSync } from 'node:fs';
import { readExr } from 'hdrify';
import { FloatType } from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';

const bytes = new Uint8Array(readFileSync('sky.exr'));
const three = new EXRLoader().setDataType(FloatType).parse(bytes.buffer), hdrify = readExr(bytes);
const mean = ({ data }) => data.filter((_, i) => i % 4 === 0).reduce((sum, x) => sum + x, 0) / (data.length / 4);
for (const [name, image] of [['three.js', three], ['hdrify', hdrify]])
    console.log('found:', name, image.width, 'x', image.height, 'mean', mean(image));
if (three.height !== 4 || mean(three) !== 1 || hdrify.height !== 4 || mean(hdrify) !== 1) process.exit(1);
JAVASCRIPT
venv/bin/python sky.py
node sky.mjs
