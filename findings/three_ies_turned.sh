#!/usr/bin/env bash
# three.js IESLoader: a profile of 90 to 270 degrees is turned by a quarter.
#
# Expected: horizontal angles of LM-63-95 may go from 90 to 270, where the halves at both sides of that plane mirror each
#           other. The light of 90 degrees is at 90, as in a file of 0 to 360 that says the same.
# Found:    the light of 90 degrees is at 0.
# Tried:    three 0.187.0 of npm, Node 20. Cycles of bpy 4.5.15 turns it likewise.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >ies.mjs <<'JAVASCRIPT'
import { FloatType } from 'three';
import { IESLoader } from 'three/examples/jsm/loaders/IESLoader.js';

const file = (horizontal, candela) => `IESNA:LM-63-1995
TILT=NONE
1 1000 1 2 ${horizontal.length} 1 2 0 0 0
1 1 100
0 180
${horizontal.join(' ')}
${horizontal.map((h) => `${candela(h)} ${candela(h)}`).join('\n')}
`;
const loader = new IESLoader();
loader.type = FloatType;
const at = (text, degrees) => loader.parse(text).image.data[degrees * 180 + 90];
// Brightest at 90, darkest at 270: both files say the same.
const half = file([90, 180, 270], (h) => ({ 90: 1000, 180: 600, 270: 200 })[h]);
const whole = file([0, 90, 180, 270, 360], (h) => ({ 90: 1000, 270: 200 })[h] ?? 600);
for (const degrees of [0, 90, 180, 270])
    console.log('found: at', degrees, 'of 0 to 360', at(whole, degrees), 'of 90 to 270', at(half, degrees));
if (at(whole, 90) !== 1 || at(half, 90) === 1 || at(half, 0) !== 1) process.exit(1);
JAVASCRIPT
node ies.mjs
