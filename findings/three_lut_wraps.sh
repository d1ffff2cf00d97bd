#!/usr/bin/env bash
# three.js LUTCubeLoader: values above 1 and below 0 of a .cube file wrap around.
#
# Expected: they are clamped, or kept, since .cube files may have any numbers, and tables of cameras and of
#           highlights that roll off do.
# Found:    by default the table is bytes, and 1.5 times 255 is taken modulo 256: white becomes 126, and a black of
#           -0.01 becomes 254. setType(FloatType) keeps them.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >lut.mjs <<'JAVASCRIPT'
import { FloatType } from 'three';
import { LUTCubeLoader } from 'three/examples/jsm/loaders/LUTCubeLoader.js';

const cube = (black, white) => `TITLE "t"\nLUT_3D_SIZE 2\n${Array.from({ length: 8 }, (_, i) =>
    [i & 1, i >> 1 & 1, i >> 2].map((on) => (on ? white : black).toFixed(3)).join(' ')).join('\n')}\n`;
const ends = (loader) => {
    const { data } = loader.parse(cube(-0.01, 1.5)).texture3D.image;
    return [data[0], data[data.length - 4]];
};
const bytes = ends(new LUTCubeLoader());
const floats = ends(new LUTCubeLoader().setType(FloatType));
console.log('found: -0.01 and 1.5 are', bytes, 'of 255, and as floats', floats);
if (bytes[0] !== 254 || bytes[1] !== 126 || Math.abs(floats[1] - 1.5) > 1e-6) process.exit(1);
JAVASCRIPT
node lut.mjs
