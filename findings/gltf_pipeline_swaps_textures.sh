#!/usr/bin/env bash
# gltf-pipeline: a clear coat gets the texture of the glass, and other extensions lose theirs.
#
# Expected: processGltf() without options, which tidies up and changes the version, keeps what a material refers to, or what
#           it does not know, as it is.
# Found:    it counts the uses of textures in a few extensions alone: transmission and specular, not clear coat, sheen,
#           volume, iridescence, anisotropy. What only these use is removed and the rest is renumbered, but their numbers
#           stay: they name another texture, or none. A material that only a variant has is removed likewise.
# Tried:    gltf-pipeline 4.3.1 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund gltf-pipeline@4.3.1
cat >textures.mjs <<'JAVASCRIPT'
import gltfPipeline from 'gltf-pipeline';

const corners = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1]).buffer);
const pixel = 'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==';
const names = ['coat', 'sheen', 'thickness', 'glass'];
const { gltf } = await gltfPipeline.processGltf({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    extensionsUsed: ['KHR_materials_clearcoat', 'KHR_materials_sheen', 'KHR_materials_volume', 'KHR_materials_transmission',
        'KHR_materials_variants'],
    extensions: { KHR_materials_variants: { variants: [{ name: 'red' }] } },
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, material: 0,
        extensions: { KHR_materials_variants: { mappings: [{ material: 1, variants: [0] }] } } }] }],
    materials: [{ name: 'all', extensions: {
        KHR_materials_clearcoat: { clearcoatFactor: 1, clearcoatTexture: { index: 0 } },
        KHR_materials_sheen: { sheenColorFactor: [1, 1, 1], sheenColorTexture: { index: 1 } },
        KHR_materials_volume: { thicknessFactor: 1, thicknessTexture: { index: 2 } },
        KHR_materials_transmission: { transmissionFactor: 1, transmissionTexture: { index: 3 } } } },
    { name: 'red', pbrMetallicRoughness: { baseColorFactor: [1, 0, 0, 1] } }],
    textures: names.map((name, source) => ({ name, source })),
    images: names.map((name) => ({ name, uri: `data:image/png;base64,${pixel}` })),
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
        { bufferView: 0, byteOffset: 36, componentType: 5126, count: 3, type: 'VEC2' }],
    bufferViews: [{ buffer: 0, byteLength: corners.length }],
    buffers: [{ byteLength: corners.length, uri: `data:application/octet-stream;base64,${corners.toString('base64')}` }],
});
const [{ extensions }] = gltf.materials;
const named = (index) => gltf.textures[index]?.name;
const found = {
    coat: named(extensions.KHR_materials_clearcoat.clearcoatTexture.index),
    sheen: named(extensions.KHR_materials_sheen.sheenColorTexture.index),
    thickness: named(extensions.KHR_materials_volume.thicknessTexture.index),
    glass: named(extensions.KHR_materials_transmission.transmissionTexture.index),
};
const [mapping] = gltf.meshes[0].primitives[0].extensions.KHR_materials_variants.mappings;
console.log('found: textures by use', found, '- materials', gltf.materials.map(({ name }) => name), '- the variant has', mapping);
if (found.coat !== 'glass' || found.sheen || found.thickness || found.glass !== 'glass') process.exit(1);
if (gltf.materials.length !== 1 || mapping.material !== 1) process.exit(1);
JAVASCRIPT
node textures.mjs
