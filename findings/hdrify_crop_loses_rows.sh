#!/usr/bin/env bash
# hdrify: an .exr whose data window starts lower loses its last rows.
#
# Expected: a file that stores rows 2 to 5 of 8 gives these four rows, or all eight with black around them.
# Found:    it gives four rows, of which the first two are black and the next two are rows 2 and 3: a row is put where its number
#           says, in a picture that starts at the window. Rows 4 and 5 are gone, with half of the light, and nothing is said.
#           A crop that starts at 0 is whole. three.js has the four rows.
# Tried:    hdrify 1.2.1, three 0.187.0 of npm, Node 20; OpenEXR 3.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund hdrify@1.2.1 three@0.187.0
python3.11 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3
cat >crop.py <<'PYTHON'
import numpy as np
import OpenEXR

rows = np.zeros((4, 8, 3), np.float32) + np.float32([2, 3, 4, 5])[:, None, None]
for start in (0, 2):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage,
              "dataWindow": (np.array([0, start], np.int32), np.array([7, start + 3], np.int32)),
              "displayWindow": (np.array([0, 0], np.int32), np.array([7, 7], np.int32))}
    OpenEXR.File(header, {"RGB": rows}).write(f"crop{start}.exr")
PYTHON
cat >crop.mjs <<'JAVASCRIPT'
import { readFileSync } from 'node:fs';
import { readExr } from 'hdrify';
import { FloatType } from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';

const rows = ({ data, width, height }) => Array.from({ length: height }, (_, y) => data[4 * width * y]);
for (const [start, expected] of [[0, '2,3,4,5'], [2, '0,0,2,3']]) {
    const bytes = new Uint8Array(readFileSync(`crop${start}.exr`));
    const three = rows(new EXRLoader().setDataType(FloatType).parse(bytes.buffer)).reverse(), hdrify = rows(readExr(bytes));
    console.log('found: window from row', start, '- hdrify', hdrify, '- three.js', three);
    if (hdrify.join() !== expected || three.join() !== '2,3,4,5') process.exit(1);
}
JAVASCRIPT
venv/bin/python crop.py
node crop.mjs
