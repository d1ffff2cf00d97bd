#!/usr/bin/env bash
# three.js EXRExporter: a panorama that came from a .hdr is written upside down.
#
# Expected: HDRLoader, then EXRExporter: the sky stays up. The exporter turns the rows of a texture whose flipY is false, as
#           EXRLoader's are, and leaves those of one whose flipY is true, as HDRLoader's are.
# Found:    flipY is not looked at, so the ground lights from above. From .exr to .exr the picture stays as it is. Whoever
#           reads `data` of both loaders meets the same: the first row of a .hdr is the zenith, that of an .exr the nadir.
# Tried:    three 0.187.0 of npm, Node 20; OpenEXR 3.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
python3.11 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3
cat >convert.mjs <<'JAVASCRIPT'
import { writeFileSync } from 'node:fs';
import { DataTexture, FloatType, RGBAFormat } from 'three';
import { EXRExporter } from 'three/examples/jsm/exporters/EXRExporter.js';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { HDRLoader } from 'three/examples/jsm/loaders/HDRLoader.js';

/** The texture that three.js' loaders make of what they parsed. */
function texture({ data, width, height, flipY }) {
    return Object.assign(new DataTexture(data, width, height, RGBAFormat, FloatType), { flipY });
}
const row = (exponent) => Array(8).fill([128, 128, 128, exponent]).flat();
const hdr = Uint8Array.from([...Buffer.from('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n'), ...row(130), ...row(128)]);
const sky = texture(new HDRLoader().setDataType(FloatType).parse(hdr.buffer));
const first = await new EXRExporter().parse(sky, { type: FloatType });
writeFileSync('first.exr', first);
const again = texture(new EXRLoader().setDataType(FloatType).parse(first.buffer));
writeFileSync('second.exr', await new EXRExporter().parse(again, { type: FloatType }));
console.log('found: flipY of the .hdr', sky.flipY, '- of the .exr', again.flipY);
if (!sky.flipY || again.flipY) process.exit(1);
JAVASCRIPT
cat >rows.py <<'PYTHON'
import OpenEXR

for name in ("first.exr", "second.exr"):
    with OpenEXR.File(name) as file:
        above, below = (float(row[0, 0]) for row in file.channels()["RGBA"].pixels)
    print("found:", name, "has", above, "above and", below, "below; the .hdr has 2 above and 0.5 below")
    assert abs(above - 0.5) < 0.01 and abs(below - 2) < 0.02
PYTHON
node convert.mjs
venv/bin/python rows.py
