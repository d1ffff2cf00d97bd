#!/usr/bin/env bash
# Babylon.js: leaves and paper that go through it are white behind, or opaque.
#
# Expected: a glTF file with KHR_materials_diffuse_transmission has the same colour and the same part after it was loaded and
#           exported again. KHR_materials_volume beside it stays what it is.
# Found:    the colour is gone, so what comes through is white, and stands as attenuationColor in a volume that the file did
#           not have. With a volume of its own the extension is gone altogether, and the volume's distance is 1.
# Tried:    @babylonjs/core, loaders and serializers 9.28.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts @babylonjs/core@9.28.0 @babylonjs/loaders@9.28.0 \
    @babylonjs/serializers@9.28.0
cat >leaf.mjs <<'JAVASCRIPT'
import assert from 'assert';
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Scene } from '@babylonjs/core/scene.js';
import { GLTF2Export } from '@babylonjs/serializers/glTF/2.0/glTFSerializer.js';
import '@babylonjs/core/Materials/standardMaterial.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import '@babylonjs/serializers/glTF/2.0/index.js';

const triangle = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer).toString('base64');

async function written(extensions) {
    const gltf = {
        asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
        extensionsUsed: Object.keys(extensions),
        buffers: [{ byteLength: 36, uri: 'data:application/octet-stream;base64,' + triangle }],
        bufferViews: [{ buffer: 0, byteLength: 36 }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
        materials: [{ pbrMetallicRoughness: { metallicFactor: 0 }, extensions }],
    };
    const scene = new Scene(new NullEngine());
    const container = await LoadAssetContainerAsync('data:' + JSON.stringify(gltf), scene, { pluginExtension: '.gltf' });
    container.addAllToScene();
    const { files } = await GLTF2Export.GLTFAsync(scene, 'a', { exportWithoutWaitingForScene: true });
    return JSON.parse(files['a.gltf']).materials[0].extensions;
}

const KHR_materials_diffuse_transmission = { diffuseTransmissionFactor: 0.5, diffuseTransmissionColorFactor: [0.5, 1, 0.25] };
const thin = await written({ KHR_materials_diffuse_transmission });
const thick = await written({
    KHR_materials_diffuse_transmission,
    KHR_materials_volume: { thicknessFactor: 0.5, attenuationDistance: 2, attenuationColor: [1, 0.5, 0.5] },
});
console.log('found: a leaf', JSON.stringify(thin));
console.log('found: a thick one', JSON.stringify(thick));
assert.deepEqual(thin.KHR_materials_diffuse_transmission, { diffuseTransmissionFactor: 0.5 });
assert.deepEqual(thin.KHR_materials_volume.attenuationColor, [0.5, 1, 0.25]);
assert(!thick.KHR_materials_diffuse_transmission);
assert.equal(thick.KHR_materials_volume.attenuationDistance, 1);
console.log('held');
process.exit(0);
JAVASCRIPT
node leaf.mjs | grep -E "found|held"
