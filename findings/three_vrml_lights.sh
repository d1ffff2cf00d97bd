#!/usr/bin/env bash
# three.js VRMLLoader: lights are left out, and everything that shines is matt.
#
# Expected: PointLight, SpotLight and DirectionalLight of VRML 2 become lights, or a line says that they do not. A shininess of
#           0..1 is an exponent of 0 to 128 [VRML97, 4.14].
# Found:    no light and no line, so a scene that brings its lamps is black. A shininess of 0.2 becomes an exponent of 0.2, not
#           25.6: the highlight is spread over the whole hemisphere. Colours are taken as sRGB and emission too: 0.5 is 0.21.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >lights.mjs <<'JAVASCRIPT'
import { VRMLLoader } from 'three/examples/jsm/loaders/VRMLLoader.js';

const said = [];
for (const name of ['warn', 'error']) console[name] = (...words) => said.push(words.join(' '));
const scene = new VRMLLoader().parse(`#VRML V2.0 utf8
Shape {
    appearance Appearance {
        material Material { diffuseColor 0.5 0.5 0.5 emissiveColor 0.5 0.5 0.5 specularColor 1 1 1 shininess 0.2 }
    }
    geometry Box { }
}
PointLight { intensity 0.5 location 0 3 0 attenuation 0 0 1 }
DirectionalLight { direction 0 -1 0 intensity 0.7 }
SpotLight { location 0 3 0 direction 0 -1 0 }
`);
let lights = 0, material;
scene.traverse((node) => { if (node.isLight) ++lights; if (node.isMesh) material = node.material; });
console.log('found: lights', lights, '- shininess', material.shininess, '- colour', material.color.r, '- emission', material.emissive.r,
    '- said', said);
if (lights !== 0 || said.length !== 0 || material.shininess !== 0.2) process.exit(1);
if (Math.abs(material.color.r - 0.214) > 0.001 || Math.abs(material.emissive.r - 0.214) > 0.001) process.exit(1);
JAVASCRIPT
node lights.mjs
