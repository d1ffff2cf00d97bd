#!/usr/bin/env bash
# three.js USDLoader: a mesh with colours of vertices has the colour of its first vertex all over.
#
# Expected: `primvars:displayColor` with a colour for each vertex, corner or face, which is how baked light and scans are kept
#           in USD, becomes colours of the geometry.
# Found:    the first number of the list is the material's colour, the others are dropped, and nothing is said. The geometry
#           has no attribute "color".
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >colors.mjs <<'JAVASCRIPT'
import { USDLoader } from 'three/examples/jsm/loaders/USDLoader.js';

const mesh = (interpolation, colors) => `#usda 1.0
(
    defaultPrim = "World"
    upAxis = "Y"
)

def Xform "World"
{
    def Mesh "strip"
    {
        int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 2, 1, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        color3f[] primvars:displayColor = [${colors.map((color) => `(${color.join(', ')})`).join(', ')}] (
            interpolation = "${interpolation}"
        )
    }
}
`;
const colors = [[0.5, 0.25, 1], [0, 1, 0], [1, 0, 0], [0, 0, 1], [0.1, 0.1, 0.1], [0.9, 0.9, 0.9]];
for (const [interpolation, count] of [['vertex', 4], ['faceVarying', 6], ['uniform', 2]]) {
    const found = [];
    new USDLoader().parse(mesh(interpolation, colors.slice(0, count))).traverse((node) => {
        if (node.isMesh) found.push({ color: node.material.color.toArray(), attribute: node.geometry.attributes.color,
            used: node.material.vertexColors });
    });
    console.log('found:', interpolation, JSON.stringify(found));
    if (found.length !== 1 || found[0].attribute || found[0].used || found[0].color.join() !== colors[0].join()) process.exit(1);
}
JAVASCRIPT
node colors.mjs
