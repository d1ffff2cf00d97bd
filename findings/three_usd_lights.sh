#!/usr/bin/env bash
# three.js USDLoader: exposure does not count, spots shine to all sides, and a ball's light does not depend on its size.
#
# Expected: UsdLux: radiance is intensity times 2 to the exposure. A ball of radius r sends it times pi r^2, a cone of
#           `inputs:shaping:cone:angle` cuts it, and a DistantLight without an intensity has 50,000.
# Found:    an intensity of 100 is a PointLight of 100 candela for r = 0.1, which should have 3.14, and for r = 0.5, with
#           exposure 3 and without, with a cone (its name is looked up without "inputs:") and without. A DistantLight
#           without an intensity has 1.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >lights.mjs <<'JAVASCRIPT'
import { USDLoader } from 'three/examples/jsm/loaders/USDLoader.js';

/** The first light that three.js finds in a stage with one light. */
function light(type, inputs, applied = '') {
    const rows = Object.entries(inputs).map(([name, value]) => `        float inputs:${name} = ${value}`).join('\n');
    let found;
    new USDLoader().parse(`#usda 1.0
(
    defaultPrim = "World"
    upAxis = "Y"
)

def Xform "World"
{
    def ${type} "lamp"${applied && ` (\n        prepend apiSchemas = ["${applied}"]\n    )`}
    {
${rows}
    }
}
`).traverse((node) => { if (node.isLight) found = { type: node.type, intensity: node.intensity }; });
    return found;
}

const found = {
    small: light('SphereLight', { intensity: 100, radius: 0.1 }), large: light('SphereLight', { intensity: 100, radius: 0.5 }),
    exposed: light('SphereLight', { intensity: 100, radius: 0.1, exposure: 3 }),
    spot: light('SphereLight', { intensity: 100, radius: 0.1, 'shaping:cone:angle': 20 }, 'ShapingAPI'),
    sun: light('DistantLight', { angle: 0.53 }),
};
console.log('found:', JSON.stringify(found));
for (const name of ['small', 'large', 'exposed', 'spot'])
    if (found[name].type !== 'PointLight' || found[name].intensity !== 100) process.exit(1);
if (found.sun.type !== 'DirectionalLight' || found.sun.intensity !== 1) process.exit(1);
JAVASCRIPT
node lights.mjs
