#!/usr/bin/env bash
# Spherical harmonics: coefficients of Babylon.js and Dr.Jit light three.js from the opposite side.
#
# Expected: real harmonics up to the second band, in the order of graphics, mean the same in all: band 1 is y, z, x times
#           0.4886, so nine coefficients can be handed from the one to the other.
# Found:    Babylon.js and Dr.Jit have the sign of Condon and Shortley: -y, z, -x, and -yz, -xz. three.js has none. A sun towards
#           +X and +Y stands at -X and -Y, turned by half a circle about Z. Bands 0 and z, xy, zz, xx - yy agree, so a
#           light from +Z alone shows nothing.
# Tried:    drjit 1.5.0 of PyPI, Python 3.11; three 0.187.0, @babylonjs/core 9.35.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 @babylonjs/core@9.35.0
python3.11 -m venv venv
venv/bin/pip install -q drjit==1.5.0
cat >basis.mjs <<'JAVASCRIPT'
import { Color3, Vector3 } from '@babylonjs/core/Maths/math.js';
import { SphericalHarmonics } from '@babylonjs/core/Maths/sphericalPolynomial.js';
import * as THREE from 'three';

const three = Array(9), babylon = new SphericalHarmonics();
THREE.SphericalHarmonics3.getBasisAt(new THREE.Vector3(0.48, 0.6, 0.64), three);
babylon.addLight(new Vector3(0.48, 0.6, 0.64), new Color3(1, 1, 1), 1);
const names = ['l00', 'l1_1', 'l10', 'l11', 'l2_2', 'l2_1', 'l20', 'l21', 'l22'];
console.log(JSON.stringify([three, names.map((name) => babylon[name].x)]));
JAVASCRIPT
node basis.mjs >web.json
cat >basis.py <<'PYTHON'
import json

import drjit

with open("web.json") as file:
    three, babylon = json.load(file)
drjit_values = [float(x) for x in drjit.sh_eval(drjit.scalar.Array3f(0.48, 0.6, 0.64), 2)]
for name, values in (("Babylon.js", babylon), ("Dr.Jit", drjit_values)):
    ratio = [round(x / y, 3) for x, y in zip(values, three)]
    print("found:", name, "over three.js, for 1, y, z, x, xy, yz, zz, xz, xx - yy:", ratio)
    assert ratio == [1, -1, 1, -1, 1, -1, 1, -1, 1]
PYTHON
venv/bin/python basis.py
