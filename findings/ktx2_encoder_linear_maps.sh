#!/usr/bin/env bash
# ktx2-encoder (npm, its transform of gltf-transform): normal maps and roughness are marked as sRGB.
#
# Expected: KHR_texture_basisu asks for a linear transfer function in the KTX 2 header of normal, occlusion and
#           metallic-roughness textures, and for sRGB in those of colours. The transform sees each texture's slots.
# Found:    one set of options serves all textures, and its default marks them all as sRGB. A loader that believes the header,
#           as three.js' KTX2Loader does, bends normals and makes surfaces smoother: a stored roughness of 0.5 becomes 0.21.
#           `isPerceptual` and `isSetKTX2SRGBTransferFunc` set by hand, with `slots`, in two passes give the right ones.
# Tried:    ktx2-encoder 0.6.0, @gltf-transform/core 4.5.1, ktx-parse 2.0.0.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund ktx2-encoder@0.6.0 @gltf-transform/core@4.5.1 @gltf-transform/extensions@4.5.1 ktx-parse@2.0.0
cat >slots.mjs <<'JS'
import assert from "assert";
import { Document } from "@gltf-transform/core";
import { read } from "ktx-parse";
import { ktx2 } from "ktx2-encoder/gltf-transform";

const print = console.log;
console.log = () => {}; // the encoder tells each step

// Flat normals: 128, 128, 255.
const data = new Uint8Array(16 * 16 * 4).map((_, i) => [128, 128, 255, 255][i % 4]);
const all = { isUASTC: true, generateMipmap: false, imageDecoder: async () => ({ width: 16, height: 16, data }) };

async function transfers(...passes) {
    const document = new Document();
    const picture = (name) => document.createTexture(name).setMimeType("image/png").setImage(new Uint8Array(8));
    document.createMaterial("look")
        .setBaseColorTexture(picture("base colour"))
        .setNormalTexture(picture("normals"))
        .setMetallicRoughnessTexture(picture("metallic, roughness"))
        .setOcclusionTexture(picture("occlusion"));
    await document.transform(...passes.map((options) => ktx2({ ...all, ...options })));
    const result = document.getRoot().listTextures().map((texture) => [
        texture.getName(), read(texture.getImage()).dataFormatDescriptor[0].transferFunction]);
    print("found: transfer functions (1 linear, 2 sRGB)", JSON.stringify(result));
    return result.map((one) => one[1]);
}

assert.deepEqual(await transfers({}), [2, 2, 2, 2]);
const linear = { slots: /normal|metallic|occlusion/, isPerceptual: false, isSetKTX2SRGBTransferFunc: false };
assert.deepEqual(await transfers({ slots: /baseColor/ }, linear), [2, 1, 1, 1]);
print("held");
JS
node slots.mjs 2>/dev/null
