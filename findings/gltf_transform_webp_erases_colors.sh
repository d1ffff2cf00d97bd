#!/usr/bin/env bash
# gltf-transform: WebP compression erases the colours of opaque materials where the texture's alpha is 0.
#
# Expected: alphaMode OPAQUE means that alpha does not count [glTF 2.0, 3.9.4], so the colours under it stay.
# Found:    white with alpha 0 beside black with alpha 0 becomes black, lossless or not. Labels and cards whose
#           material is opaque get black. The encoder, sharp, throws away the colours under alpha 0.
# Tried:    @gltf-transform/core and functions 4.5.1, sharp 0.35.5 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/{core,extensions,functions}@4.5.1 sharp@0.35.5
cat >webp.mjs <<'JAVASCRIPT'
import { Document } from '@gltf-transform/core';
import { textureCompress } from '@gltf-transform/functions';
import sharp from 'sharp';

const side = 64;
const texels = Buffer.alloc(4 * side * side);
for (let i = 0; i < side * side; ++i) texels.set(i % side < side / 2 ? [0, 0, 0, 0] : [255, 255, 255, 0], 4 * i);
const png = await sharp(texels, { raw: { width: side, height: side, channels: 4 } }).png().toBuffer();
for (const lossless of [false, true]) {
    const document = new Document();
    const texture = document.createTexture().setMimeType('image/png').setImage(png);
    document.createMaterial().setAlphaMode('OPAQUE').setBaseColorTexture(texture);
    await document.transform(textureCompress({ encoder: sharp, targetFormat: 'webp', lossless }));
    const after = await sharp(texture.getImage()).raw().toBuffer();
    const at = 4 * (side / 2 * side + 3 * side / 4);
    console.log('found:', lossless ? 'lossless' : 'lossy', 'white under alpha 0 is', [...after.subarray(at, at + 4)]);
    if (after[at] > 32 || after[at + 3] !== 0) process.exit(1);
}
JAVASCRIPT
node webp.mjs
