#!/usr/bin/env bash
# obj2gltf: a lamp becomes an invalid file, and a texture forgets what it is multiplied by.
#
# Expected: Ke above 1 is an emissiveFactor of at most 1 with KHR_materials_emissive_strength, and Kd times map_Kd is
#           baseColorFactor times baseColorTexture.
# Found:    Ke 10 5 2 is written as emissiveFactor [10, 5, 2], which glTF does not allow: the validator has three errors, and
#           readers that cut off at 1 show white light. Beside a map Kd is dropped: 0.5 times a texture is twice as bright.
# Tried:    obj2gltf 3.2.0, gltf-validator 2.0.0-dev.3.10 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund obj2gltf@3.2.0 gltf-validator@2.0.0-dev.3.10
echo 'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==' | base64 -d >grey.png
printf 'newmtl lamp\nKd 0 0 0\nKe 10 5 2\nnewmtl print\nKd 0.5 0.25 0.1\nmap_Kd grey.png\n' >room.mtl
printf 'mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n' >room.obj
for name in lamp print; do printf 'o %s\nusemtl %s\nf 1/1 2/2 3/3\n' "$name" "$name" >>room.obj; done
cat >room.mjs <<'JAVASCRIPT'
import validator from 'gltf-validator';
import obj2gltf from 'obj2gltf';

const gltf = await obj2gltf('room.obj');
const { issues } = await validator.validateString(JSON.stringify(gltf));
const errors = issues.messages.filter(({ severity }) => severity === 0).map(({ code, pointer }) => `${code} ${pointer}`);
const [lamp, print] = ['lamp', 'print'].map((wanted) => gltf.materials.find(({ name }) => name === wanted));
console.log('found: lamp', lamp.emissiveFactor, lamp.extensions, '- print', print.pbrMetallicRoughness, '- errors', errors);
if (lamp.emissiveFactor.join() !== '10,5,2' || lamp.extensions) process.exit(1);
if (print.pbrMetallicRoughness.baseColorFactor.join() !== '1,1,1,1' || !print.pbrMetallicRoughness.baseColorTexture) process.exit(1);
if (errors.filter((error) => error.startsWith('VALUE_NOT_IN_RANGE /materials')).length !== 3) process.exit(1);
JAVASCRIPT
node room.mjs
