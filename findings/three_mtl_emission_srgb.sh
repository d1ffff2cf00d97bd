#!/usr/bin/env bash
# three.js MTLLoader: a lamp of 10 becomes one of 224, and warm light becomes red.
#
# Expected: Ke is light: 10 5 2 is emission of 10, 5 and 2, as Blender writes and reads it. A colour of a surface is within
#           0..1, so one may ask whether it is sRGB; light above 1 is none that a display shows.
# Found:    Ke goes through the sRGB curve like Kd, beyond its end as well: 224, 43 and 5. Light of 0.5 becomes 0.21.
#           obj2gltf takes all these numbers, and those of Kd, as linear.
# Tried:    three 0.187.0, obj2gltf 3.2.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 obj2gltf@3.2.0
cat >lamp.mtl <<'MTL'
newmtl lamp
Kd 0.5 0.5 0.5
Ke 10 5 2
newmtl glimmer
Kd 0.5 0.5 0.5
Ke 0.5 0.5 0.5
MTL
printf 'mtllib lamp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no a\nusemtl lamp\nf 1 2 3\no b\nusemtl glimmer\nf 1 2 3\n' >lamp.obj
cat >lamp.mjs <<'JAVASCRIPT'
import { readFileSync } from 'node:fs';
import obj2gltf from 'obj2gltf';
import { MTLLoader } from 'three/examples/jsm/loaders/MTLLoader.js';

const creator = new MTLLoader().parse(readFileSync('lamp.mtl', 'utf8'), '');
creator.preload();
const { lamp, glimmer } = creator.materials;
const { materials } = await obj2gltf('lamp.obj');
console.log('found: three.js:', lamp.emissive.toArray(), lamp.emissiveIntensity, glimmer.emissive.toArray(),
    lamp.color.toArray());
console.log('found: obj2gltf:', materials.map(({ emissiveFactor, pbrMetallicRoughness }) =>
    [emissiveFactor, pbrMetallicRoughness.baseColorFactor]));
const near = (values, expected) => values.every((value, i) => Math.abs(value / expected[i] - 1) < 0.01);
if (!near(lamp.emissive.toArray(), [223.8, 42.97, 4.954]) || lamp.emissiveIntensity !== 1) process.exit(1);
if (!near(glimmer.emissive.toArray(), [0.214, 0.214, 0.214])) process.exit(1);
if (!near(materials[0].emissiveFactor, [10, 5, 2]) || materials[0].pbrMetallicRoughness.baseColorFactor[0] !== 0.5) process.exit(1);
JAVASCRIPT
node lamp.mjs
