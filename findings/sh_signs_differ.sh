#!/usr/bin/env bash
# Spherical harmonics: coefficients of Dr.Jit light three.js from the opposite side.
#
# Expected: real harmonics up to the second band, in the order of graphics, mean the same in both: band 1 is y, z, x times
#           0.4886, so nine coefficients can be handed from the one to the other.
# Found:    Dr.Jit has the sign of Condon and Shortley: -y, z, -x, and in band 2 -yz and -xz. three.js has none. A sun towards
#           +X and +Y stands at -X and -Y, turned by half a circle about Z. Bands 0 and z, xy, zz, xx - yy agree, so a
#           light from +Z alone shows nothing.
# Tried:    drjit 1.5.0 of PyPI, Python 3.11; three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
python3.11 -m venv venv
venv/bin/pip install -q drjit==1.5.0
cat >basis.mjs <<'JAVASCRIPT'
import { SphericalHarmonics3, Vector3 } from 'three';

const basis = Array(9);
SphericalHarmonics3.getBasisAt(new Vector3(0.48, 0.6, 0.64), basis);
console.log(JSON.stringify(basis));
JAVASCRIPT
node basis.mjs >three.json
cat >basis.py <<'PYTHON'
import json

import drjit

with open("three.json") as file:
    three = json.load(file)
ours = [float(x) for x in drjit.sh_eval(drjit.scalar.Array3f(0.48, 0.6, 0.64), 2)]
ratio = [round(x / y, 3) for x, y in zip(ours, three)]
print("found: Dr.Jit", [round(x, 4) for x in ours], "three.js", [round(x, 4) for x in three])
print("found: ratios for 1, y, z, x, xy, yz, zz, xz, xx - yy", ratio)
assert [round(x) for x in ratio] == [1, -1, 1, -1, 1, -1, 1, -1, 1] and max(abs(abs(x) - 1) for x in ratio) < 0.001
PYTHON
venv/bin/python basis.py
