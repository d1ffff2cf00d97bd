#!/usr/bin/env bash
# Babylon.js (SpotLight.iesProfileTexture): a lamp's profile is that of its first plane, all around.
#
# Expected: a wall washer that has 200 candela towards the wall (C90) and 20 towards the other sides is brighter on one side,
#           or is refused, as a spot has to be round.
# Found:    the texture is 180 x 1, the plane C0 alone, divided by the largest candela of all planes. So the spot has a tenth
#           of its light to all sides, and the light towards the wall is nowhere. The other planes are computed and dropped.
# Tried:    @babylonjs/core 9.35.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @babylonjs/core@9.35.0
cat >washer.mjs <<'JAVASCRIPT'
import { LoadIESData } from '@babylonjs/core/Lights/IES/iesLoader.js';

const planes = { 0: 20, 90: 200, 180: 20, 270: 20, 360: 20 };
const file = `IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 5 1 2 0 0 0
1 1 10
0 45 90
${Object.keys(planes).join(' ')}
${Object.values(planes).map((candela) => `${candela} ${candela} ${candela}`).join('\n')}
`;
const { width, height, data } = LoadIESData(new TextEncoder().encode(file));
const shown = Array.from(data.slice(0, 90));
console.log('found:', width, 'x', height, 'with', Math.min(...shown), 'to', Math.max(...shown), 'of', data.length, 'numbers, the largest',
    data.reduce((a, b) => Math.max(a, b)));
if (width !== 180 || height !== 1 || shown.some((x) => Math.abs(x - 0.1) > 1e-6) || data[45 + 90 * 180] !== 1) process.exit(1);
JAVASCRIPT
node washer.mjs
