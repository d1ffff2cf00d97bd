#!/usr/bin/env bash
# three.js HDRLoader: X Y Z of a .hdr are taken as red, green and blue, and all light is 0.4 % too bright.
#
# Expected: the loader converts FORMAT=32-bit_rle_xyze, or refuses it as others do. The mantissas 128 128 128 with
#           exponent 129 are 1.0: Radiance has m / 256 times 2^(e - 128).
# Found:    a white of X Y Z comes out bluish, 0.957 1.004 1.090, without a word. Mantissas are divided by 255.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >hdr.mjs <<'JAVASCRIPT'
import { FloatType } from 'three';
import { HDRLoader } from 'three/examples/jsm/loaders/HDRLoader.js';

const loader = new HDRLoader();
loader.type = FloatType;
function read(format, pixel) {
    const bytes = Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=${format}\n\n-Y 1 +X 8\n`),
        Buffer.from(Array(8).fill(pixel).flat())]);
    return Array.from(loader.parse(new Uint8Array(bytes).buffer).data.slice(0, 3));
}
const one = read('32-bit_rle_rgbe', [128, 128, 128, 129]);
const white = read('32-bit_rle_xyze', [122, 128, 139, 129]); // D65
console.log('found: 1 is', one, 'and the white of X Y Z', white);
const near = (a, b) => Math.abs(a - b) < 1e-3;
if (!near(one[0], 256 / 255) || !near(white[0], 122 / 127.5) || !near(white[2], 139 / 127.5)) process.exit(1);
JAVASCRIPT
node hdr.mjs
