#!/usr/bin/env bash
# three.js IESLoader: a downlight takes light away from what is above it.
#
# Expected: a profile whose vertical angles end at 90 degrees gives nothing above: LM-63 has that for all light below.
# Found:    the loader goes on with the slope of the last two angles. 100 candela at 80 degrees and 0 at 90 become
#           -10 % of the largest at 100 degrees and -90 % at 179. Such a texture times a lamp's light is negative, so a
#           ceiling above the lamp gets darker than unlit. The file's candela are divided by the largest.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >ies.mjs <<'JAVASCRIPT'
import { FloatType } from 'three';
import { IESLoader } from 'three/examples/jsm/loaders/IESLoader.js';

const profile = `IESNA:LM-63-2002
TILT=NONE
1 1000 1 4 1 1 2 0 0 0
1 1 100
0 45 80 90
0
1000 800 100 0
`;
const loader = new IESLoader();
loader.type = FloatType;
const { data } = loader.parse(profile).image;
const at = (degrees) => data[degrees];
console.log('found: straight down', at(0), 'at 80', at(80), 'at 100', at(100), 'at 179', at(179));
if (at(0) !== 1 || !(at(100) < -0.09) || !(at(179) < -0.85)) process.exit(1);
JAVASCRIPT
node ies.mjs
