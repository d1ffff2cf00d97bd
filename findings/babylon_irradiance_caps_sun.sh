#!/usr/bin/env bash
# Babylon.js: light above 4,096 does not count in the irradiance of an environment.
#
# Expected: the spherical polynomial, which lights everything diffuse, has all of the light that the cube's faces have: a
#           face of 65,536 gives 16 times the irradiance of one of 4,096.
# Found:    the same irradiance. A sun of 65,536 in a panorama gives a sixteenth of its light to what is matt, and all
#           of it to what mirrors it. CubeMapToSphericalPolynomialTools.MAX_HDRI_VALUE = Infinity takes the end away.
# Tried:    @babylonjs/core 9.35.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @babylonjs/core@9.35.0
cat >irradiance.mjs <<'JAVASCRIPT'
import { CubeMapToSphericalPolynomialTools as Tools } from
    '@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js';

/** What a surface that looks up gets from a sky whose upper face alone has light. */
function irradiance(radiance) {
    const size = 16, faces = { size, format: 4, type: 1, gammaSpace: false };
    for (const name of ['right', 'left', 'up', 'down', 'front', 'back'])
        faces[name] = new Float32Array(3 * size * size).fill(name === 'up' ? radiance : 0);
    const polynomial = Tools.ConvertCubeMapToSphericalPolynomial(faces);
    return polynomial.yy.x + polynomial.y.x;
}

const values = [2048, 4096, 65536], found = values.map(irradiance);
Tools.MAX_HDRI_VALUE = Infinity;
const free = irradiance(65536);
console.log('found:', values.map((value, i) => `${value} gives ${found[i].toFixed(1)}`).join(', '), '- without end', free);
if (found[2] !== found[1] || Math.abs(found[1] / found[0] - 2) > 1e-5 || Math.abs(free / found[1] - 16) > 1e-5)
    process.exit(1);
JAVASCRIPT
node irradiance.mjs
