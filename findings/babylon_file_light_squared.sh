#!/usr/bin/env bash
# Babylon.js: the intensity of a glTF file's own environment counts twice for what is matt, and without one it is no number.
#
# Expected: `intensity` of EXT_lights_image_based multiplies the environment, and is 1 where the file has none.
# Found:    the loader multiplies the irradiance coefficients by it and sets the texture's level to it; the shader multiplies
#           irradiance by the level once more. With an intensity of 2 matt surfaces get 4 times the light, mirrors twice.
#           Without `intensity` the coefficients are multiplied by undefined: the irradiance is NaN.
# Tried:    @babylonjs/core and @babylonjs/loaders 9.28.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts @babylonjs/core@9.28.0 @babylonjs/loaders@9.28.0
cat >light.mjs <<'JAVASCRIPT'
import assert from 'assert';
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { InternalTexture, InternalTextureSource } from '@babylonjs/core/Materials/Textures/internalTexture.js';
import { RawCubeTexture } from '@babylonjs/core/Materials/Textures/rawCubeTexture.js';
import { Scene } from '@babylonjs/core/scene.js';
import { pbrBlockReflection as shader } from '@babylonjs/core/Shaders/ShadersInclude/pbrBlockReflection.js';
import '@babylonjs/loaders/glTF/2.0/index.js';

// Without a graphics card: what the loader would upload is kept.
let seen;
NullEngine.prototype.createRawCubeTexture = function () {
    return new InternalTexture(this, InternalTextureSource.CubeRaw);
};
RawCubeTexture.prototype.updateRGBDAsync = async function (images, polynomial) {
    seen = { irradiance: polynomial.xx.x, level: this.level };
};
const face = 'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==';

async function loaded(intensity) {
    const light = {
        irradianceCoefficients: [[1, 1, 1], ...Array.from({ length: 8 }, () => [0, 0, 0])],
        specularImages: [[0, 0, 0, 0, 0, 0]], specularImageSize: 1, ...intensity,
    };
    const gltf = {
        asset: { version: '2.0' }, extensionsUsed: ['EXT_lights_image_based'], images: [{ uri: face }],
        extensions: { EXT_lights_image_based: { lights: [light] } }, nodes: [{}], scene: 0,
        scenes: [{ nodes: [0], extensions: { EXT_lights_image_based: { light: 0 } } }],
    };
    await LoadAssetContainerAsync('data:' + JSON.stringify(gltf), new Scene(new NullEngine()), { pluginExtension: '.gltf' });
    return seen;
}

const one = await loaded({ intensity: 1 }), two = await loaded({ intensity: 2 }), none = await loaded({});
console.log('found: intensity 1', one, '2', two, 'none', none);
assert.equal(two.irradiance / one.irradiance, 2);
assert.equal(two.level / one.level, 2);
assert(Number.isNaN(none.irradiance) && none.level === 1);
// vReflectionInfos.x is the level.
assert(shader.shader.includes('environmentIrradiance*=vReflectionColor.rgb*vReflectionInfos.x;'));
console.log('held');
process.exit(0);
JAVASCRIPT
node light.mjs | grep -E "found|held"
