#!/usr/bin/env bash
# gltf-transform: WebP compression mixes the channels of occlusion, roughness and metallic.
#
# Expected: a texture of data is compressed so that its channels stay apart, or losslessly: gltf-transform knows which
#           slot of a material has it.
# Found:    it becomes lossy WebP as colours do, whose chroma has half of the resolution. Columns of metallic 0 and 255,
#           one texel wide, beside a constant roughness of 128 and no occlusion become metallic 95 and 123, roughness
#           116 and 144, occlusion 242. So metal and paint beside each other are half metals.
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
const texels = Buffer.alloc(3 * side * side);
for (let i = 0; i < side * side; ++i) texels.set([255, 128, i % 2 ? 255 : 0], 3 * i);
const document = new Document();
const texture = document.createTexture().setMimeType('image/png')
    .setImage(await sharp(texels, { raw: { width: side, height: side, channels: 3 } }).png().toBuffer());
document.createMaterial().setMetallicRoughnessTexture(texture).setOcclusionTexture(texture);
await document.transform(textureCompress({ encoder: sharp, targetFormat: 'webp' }));
const after = await sharp(texture.getImage()).raw().toBuffer();
const at = 3 * (side / 2 * side + side / 2);
const [even, odd] = [after.subarray(at, at + 3), after.subarray(at + 3, at + 6)];
console.log('found:', texture.getMimeType(), 'of', [255, 128, 0], [255, 128, 255], 'is', [...even], [...odd]);
if (!(even[2] > 60 && odd[2] < 190 && even[0] < 250)) process.exit(1);
JAVASCRIPT
node webp.mjs
