#!/usr/bin/env bash
# hdrify: a .hdr that it writes has only the light of a byte below 1: what is darker than 1/256 is black.
#
# Expected: RGBE keeps about 1 % of any light, however dark, since the exponent goes down to -128.
# Found:    writeHdr() never writes an exponent below 0, so everything below 1 has steps of 1/256, without a curve for the eye.
#           0.003 becomes 0 and 0.01 becomes 0.0078 in three.js. A night sky loses its light and a dim room gets bands. Light of
#           1 and more is as it should be.
# Tried:    hdrify 1.2.1 and three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund hdrify@1.2.1 three@0.187.0
cat >write.mjs <<'JAVASCRIPT'
import { writeHdr } from 'hdrify';
import { FloatType } from 'three';
import { HDRLoader } from 'three/examples/jsm/loaders/HDRLoader.js';

const light = [0.0001, 0.003, 0.005, 0.01, 1.5, 1000, 50000, 50000];
const data = Float32Array.from(light.flatMap((value) => [value, value, value, 1]));
const file = writeHdr({ width: light.length, height: 1, data, linearColorSpace: 'linear-rec709' });
const read = new HDRLoader().setDataType(FloatType).parse(file.buffer).data.filter((_, i) => i % 4 === 0);
light.forEach((value, i) => console.log('found:', value, 'comes back as', read[i]));
if (read[0] !== 0 || read[1] !== 0 || read[2] > 0.004 || read[3] > 0.008) process.exit(1);
if (light.some((value, i) => value > 1 && Math.abs(read[i] / value - 1) > 0.01)) process.exit(1);
JAVASCRIPT
node write.mjs
