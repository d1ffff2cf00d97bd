#!/usr/bin/env bash
# gltf-transform: textures of colour get darker when they are made smaller.
#
# Expected: a texel of the smaller texture has the mean light of those that it replaces, since glTF's base colours and
#           emission are sRGB: 188 for black and white by halves.
# Found:    128, the mean of the bytes, whose light is 0.22 in place of 0.5. Fine grain, foliage and emissive grids
#           lose up to half of their light, so an asset's small version is darker than the large one. The encoder is
#           sharp, which averages bytes unless it is told otherwise.
# Tried:    @gltf-transform/core and functions 4.5.1, sharp 0.35.5 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/{core,extensions,functions}@4.5.1 sharp@0.35.5
cat >resize.mjs <<'JAVASCRIPT'
import { Document } from '@gltf-transform/core';
import { textureCompress } from '@gltf-transform/functions';
import sharp from 'sharp';

const side = 64;
const texels = Buffer.alloc(3 * side * side);
for (let i = 0; i < side * side; ++i) texels.fill((i + Math.floor(i / side)) % 2 ? 255 : 0, 3 * i, 3 * i + 3);
const document = new Document();
const texture = document.createTexture().setMimeType('image/png')
    .setImage(await sharp(texels, { raw: { width: side, height: side, channels: 3 } }).png().toBuffer());
document.createMaterial().setBaseColorTexture(texture).setEmissiveTexture(texture).setEmissiveFactor([1, 1, 1]);
await document.transform(textureCompress({ encoder: sharp, targetFormat: 'png', resize: [side / 2, side / 2] }));
const { data, info } = await sharp(texture.getImage()).raw().toBuffer({ resolveWithObject: true });
const middle = data[info.channels * (info.width * info.height / 2 + info.width / 2)];
console.log('found: a checker of 0 and 255 at half of its size is', middle, 'and its light', ((middle / 255 + 0.055) / 1.055) ** 2.4);
if (info.width !== side / 2 || Math.abs(middle - 128) > 1) process.exit(1);
JAVASCRIPT
node resize.mjs
