// A glTF of three.js in the light of its scene: node gltf.mjs [SCENE.glb SCENE.relight]. In a page, GLTFLoader.loadAsync()
// takes the place of readFile(), and a renderer draws the scene.
import { readFile } from 'node:fs/promises';
import { Scene } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Relighter } from 'relumine';
import { LitObject } from 'relumine/three';

// GLTFLoader looks for it where a file has textures; node has none, and does not decode them.
globalThis.self ??= globalThis;
const here = new URL('.', import.meta.url);
const [glb = new URL('scene.glb', here), file = new URL('scene.relight', here)] = process.argv.slice(2);
const bytes = await readFile(glb);
const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), '');
const relighter = await Relighter.open(file);
const lit = await LitObject.of(gltf.scene, relighter);
const world = new Scene().add(gltf.scene);
if (lit.rest)
    world.add(lit.rest);

// A sky that is brighter towards the top, [height][width][3].
const [width, height] = [64, 32];
relighter.light({ width, height, latLong: Array.from({ length: 3 * width * height }, (_, i) => 1.5 - i / (3 * width * height)) });
await lit.update();
world.traverse((mesh) => {
    if (mesh.isMesh)
        console.log(mesh.name, 'is at most', Math.max(...mesh.geometry.getAttribute('color').array).toFixed(3));
});
