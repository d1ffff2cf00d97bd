#!/usr/bin/env bash
# gltfpack: -noq, "disable quantization", still makes bytes of the light in vertices.
#
# Expected: with -noq attributes stay floats, as positions and texture coordinates do; without it colours may become bytes.
# Found:    COLOR_0 becomes bytes of linear light either way: 50 becomes 1, 0.001 becomes 0, 0.002 twice as bright. A baked
#           floor loses its lamp and its shadows. -vc 16 has 16 bits, which keep the shadows; 50 is still 1.
# Tried:    gltfpack 1.3.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund gltfpack@1.3.0
cat >colors.mjs <<'JAVASCRIPT'
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';

const numbers = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 50, 2, 1, 1, 0.001, 0.5, 1, 1, 0.002, 0, 0, 1]);
const data = Buffer.from(numbers.buffer);
writeFileSync('in.gltf', JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, COLOR_0: 1 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
        { bufferView: 0, byteOffset: 36, componentType: 5126, count: 3, type: 'VEC4' }],
    bufferViews: [{ buffer: 0, byteLength: data.length }],
    buffers: [{ byteLength: data.length, uri: `data:application/octet-stream;base64,${data.toString('base64')}` }],
}));
for (const [type, least, ...options] of [[5121, [0, 1]], [5121, [0, 1], '-noq'], [5123, [66, 131], '-vc', '16']]) {
    execFileSync('node', ['node_modules/gltfpack/cli.js', '-i', 'in.gltf', '-o', 'out.gltf', ...options]);
    const gltf = JSON.parse(readFileSync('out.gltf'));
    const { attributes } = gltf.meshes[0].primitives[0];
    const accessor = gltf.accessors[attributes.COLOR_0], view = gltf.bufferViews[accessor.bufferView];
    const start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    const data = readFileSync(gltf.buffers[0].uri);
    const red = [0, 1, 2].map((i) => start + view.byteStride * i).map((at) => type === 5121 ? data[at] : data.readUInt16LE(at));
    console.log('found:', options.join(' ') || 'no option', '- type of colours', accessor.componentType, 'of positions',
        gltf.accessors[attributes.POSITION].componentType, '- 50, 0.001 and 0.002 are', red, 'of', type === 5121 ? 255 : 65535);
    if (accessor.componentType !== type || red.join() !== [type === 5121 ? 255 : 65535, ...least].join()) process.exit(1);
    if (options[0] === '-noq' && gltf.accessors[attributes.POSITION].componentType !== 5126) process.exit(1);
}
JAVASCRIPT
node colors.mjs
