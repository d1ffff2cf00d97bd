#!/usr/bin/env bash
# Babylon.js: glass of glTF parts colours the more, the less the file says.
#
# Expected: KHR_materials_dispersion has 20 over Abbe's number, and so has PBRMaterial.subSurface.dispersion: 0.5 stays 0.5,
#           also when the scene is exported as glTF again.
# Found:    the loader sets `20 / dispersion`: 0.1 (less than water) becomes 200, 0.5 becomes 40, 2 (rutile) becomes 10. The
#           exporter writes that number, so a file that went through has a dispersion of 200.
# Tried:    @babylonjs/core, loaders and serializers 9.28.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts @babylonjs/core@9.28.0 @babylonjs/loaders@9.28.0 \
    @babylonjs/serializers@9.28.0
cat >glass.mjs <<'JAVASCRIPT'
import assert from 'assert';
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Scene } from '@babylonjs/core/scene.js';
import { GLTF2Export } from '@babylonjs/serializers/glTF/2.0/glTFSerializer.js';
import '@babylonjs/core/Materials/standardMaterial.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import '@babylonjs/serializers/glTF/2.0/index.js';

const triangle = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer).toString('base64');

/** Dispersion of the loaded material, and of the file that is written of it. */
async function through(dispersion) {
    const gltf = {
        asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
        extensionsUsed: ['KHR_materials_transmission', 'KHR_materials_volume', 'KHR_materials_dispersion'],
        buffers: [{ byteLength: 36, uri: 'data:application/octet-stream;base64,' + triangle }],
        bufferViews: [{ buffer: 0, byteLength: 36 }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
        materials: [{ extensions: {
            KHR_materials_transmission: { transmissionFactor: 1 }, KHR_materials_volume: { thicknessFactor: 1 },
            KHR_materials_dispersion: { dispersion } } }],
    };
    const scene = new Scene(new NullEngine());
    const container = await LoadAssetContainerAsync('data:' + JSON.stringify(gltf), scene, { pluginExtension: '.gltf' });
    container.addAllToScene();
    const { files } = await GLTF2Export.GLTFAsync(scene, 'a', { exportWithoutWaitingForScene: true });
    const written = JSON.parse(files['a.gltf']).materials[0].extensions.KHR_materials_dispersion.dispersion;
    return [container.materials[0].subSurface.dispersion, written];
}

for (const [given, found] of [[0.1, 200], [0.5, 40], [2, 10]]) {
    const [loaded, written] = await through(given);
    console.log('found: dispersion', given, 'is loaded as', loaded, 'and written as', written);
    assert.deepEqual([loaded, written], [found, found]);
}
console.log('held');
process.exit(0);
JAVASCRIPT
node glass.mjs | grep -E "found|held"
