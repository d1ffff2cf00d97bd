// The package's scene in node: light is as bright as it should be, in each vertex that GLTFLoader gives.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { access, readFile } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

// As a program in this folder finds its packages, not as one beside this file.
const require = createRequire(path.join(process.cwd(), 'program.mjs'));
const find = (name) => import(pathToFileURL(require.resolve(name)));
const { Relighter } = await find('relumine');
const { LitObject } = await find('relumine/three');
const { GLTFLoader } = await find('three/addons/loaders/GLTFLoader.js');

// The page's import map leads to files.
const example = 'node_modules/relumine/example/';
const page = await readFile(`${example}index.html`, 'utf8');
const {imports} = JSON.parse(page.match(/<script type="importmap">([^]*?)<\/script>/)[1]);
for (const name of ['three', 'three/addons/', 'relumine', 'relumine/three'])
    await access(`${example}${imports[name]}`);
for (const [, name] of (await readFile(`${example}page.js`, 'utf8')).matchAll(/(?:from|import\() ?'three\/addons\/([^']+)'/g))
    await access(`${example}${imports['three/addons/']}${name}`);

const bytes = await readFile('node_modules/relumine/example/scene.glb');
const { scene } = await new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, '');
const relighter = await Relighter.open('node_modules/relumine/example/scene.relight');
const lit = await LitObject.of(scene, relighter);
relighter.light({ cubeMap: new Float32Array(6 * 16 * 16 * 3).fill(1) });
await lit.update();

// Under an even sky no surface is brighter than the sky, and an open floor is nearly as bright.
let most = 0, meshes = 0;
scene.traverse((mesh) => {
    if (!mesh.isMesh)
        return;
    const { array } = mesh.geometry.getAttribute('color');
    assert.ok(array.every((value) => value >= 0 && value < 1.02), mesh.name);
    most = array.reduce((all, value) => Math.max(all, value), most);
    ++meshes;
});
assert.ok(most > 0.95, `expected light near 1, got ${most}`);
assert.ok(meshes > 1, `expected several primitives, got ${meshes}`);
console.log(`relumine: ${meshes} meshes of GLTFLoader on ${relighter.info.numReceivers} receivers, the brightest has ${most.toFixed(3)}`);
