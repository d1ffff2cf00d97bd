// Light on objects of three.js: three_test.mjs PACKAGE VENDORED SCENE.glb SCENE.relight
// PACKAGE: the folder of relumine.js; VENDORED: a folder with three in its node_modules.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {after, test} from 'node:test';
import {pathToFileURL} from 'node:url';

const [folder, vendored, glb, relight] = process.argv.slice(2).map((each) => path.resolve(each));
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), 'relumine-three-'));
after(() => fs.rmSync(scratch, {recursive: true}));
const modules = path.join(scratch, 'node_modules');
fs.cpSync(folder, path.join(modules, 'relumine'), {recursive: true});
fs.symlinkSync(path.join(vendored, 'node_modules/three'), path.join(modules, 'three'));
const load = (name) => import(pathToFileURL(path.join(modules, name)));
const {Relighter} = await load('relumine/relumine.js');
const {LitObject, receiversOf} = await load('relumine/three.js');
const THREE = await load('three/build/three.module.js');
const {GLTFLoader} = await load('three/examples/jsm/loaders/GLTFLoader.js');

/** A scene whose receivers are these vertices, each with its number as light. */
function sceneOf(positions, normals, triangles) {
    return {
        info: {kind: 'vertices'}, positions: () => new Float32Array(positions), normals: () => new Float32Array(normals),
        triangles: () => new Uint32Array(triangles), radiance: () => Float32Array.from(positions, (_, i) => 1 + Math.floor(i / 3)),
    };
}

/** The vertices of boxes as they stand, in another order than three.js has them. */
function boxes(centres) {
    const positions = [], normals = [], triangles = [];
    for (const [x, y, z] of centres) {
        const box = new THREE.BoxGeometry().translate(x, y, z), first = positions.length / 3;
        const count = box.attributes.position.count;
        for (let i = count - 1; i >= 0; --i) {
            positions.push(...box.attributes.position.array.subarray(3 * i, 3 * i + 3));
            normals.push(...box.attributes.normal.array.subarray(3 * i, 3 * i + 3));
        }
        triangles.push(...Array.from(box.index.array, (i) => first + count - 1 - i));
    }
    return {positions, normals, triangles};
}

test('each vertex gets its own receiver, where nodes share a mesh and the object was moved', async () => {
    const {positions, normals, triangles} = boxes([[0, 0, 0], [3, 0, 0]]);
    const floor = [-9, -1, -9, -9, -1, 9, 9, -1, 9];
    const scene = sceneOf([...positions, ...floor], [...normals, 0, 1, 0, 0, 1, 0, 0, 1, 0], [...triangles, 48, 49, 50]);
    const geometry = new THREE.BoxGeometry(), material = new THREE.MeshStandardMaterial({color: 0x808080, opacity: 0.5, transparent: true});
    const object = new THREE.Group();
    for (const x of [0, 3])
        object.add(new THREE.Mesh(geometry, material)).children.at(-1).position.x = x;
    object.position.set(7, 8, 9);
    object.scale.setScalar(2);
    const lit = await LitObject.of(object, scene);
    await lit.update();
    object.children.forEach((mesh, box) => {
        const color = mesh.geometry.getAttribute('color');
        for (let i = 0; i < 24; ++i)
            assert.equal(color.getX(i), 24 * box + 24 - i);
        assert.equal(mesh.material.opacity, 0.5);
    });
    assert.equal(lit.rest.geometry.index.count, 3);
    assert.equal(lit.rest.geometry.getAttribute('color').getX(48), 49);
    assert.equal(geometry.getAttribute('color'), undefined, 'others may have the geometry');
});

test('vertex colours and missing normals are taken into account', async () => {
    const {positions, normals, triangles} = boxes([[0, 0, 0]]);
    const geometry = new THREE.BoxGeometry();
    geometry.deleteAttribute('normal');
    geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(4 * 24).fill(51), 4, true));
    const object = new THREE.Group().add(new THREE.Mesh(geometry, new THREE.MeshStandardMaterial()));
    const lit = await LitObject.of(object, sceneOf(positions, normals, triangles));
    await lit.update();
    const shown = object.children[0].geometry, color = shown.getAttribute('color');
    assert.equal(shown.getAttribute('position').count, 36);
    for (let i = 0; i < 36; ++i) {
        assert.ok(Math.abs(5 * color.getX(i) - (24 - geometry.index.getX(i))) < 1e-4);
        assert.ok(Math.abs(color.getW(i) - 0.2) < 1e-6);
    }
    assert.equal(lit.rest, undefined);
});

test('an object that is not the scene is refused', async () => {
    const {positions, normals, triangles} = boxes([[0, 0, 0]]);
    const other = new THREE.Group().add(new THREE.Mesh(new THREE.BoxGeometry().translate(0.01, 0, 0)));
    const message = /expected the object that the scene was made of: 24 of its 24 vertices are not the scene's/;
    assert.throws(() => receiversOf(other, new Float32Array(positions), new Float32Array(normals)), {name: 'RelumineError', message});
    await assert.rejects(LitObject.of(new THREE.Group(), sceneOf(positions, normals, triangles)), {message: /0 of its 0/});
    const pixels = {...sceneOf(positions, normals, triangles), info: {kind: 'pixels'}};
    await assert.rejects(LitObject.of(other, pixels), {message: /expected a scene of vertices, got one of pixels/});
});

test('what GLTFLoader gives is as bright as an even sky at most', async () => {
    const {scene} = await new GLTFLoader().parseAsync(Uint8Array.from(fs.readFileSync(glb)).buffer, '');
    const relighter = await Relighter.open(relight); // the path of a file
    const lit = await LitObject.of(scene, relighter);
    relighter.light({cubeMap: new Float32Array(6 * 16 * 16 * 3).fill(1)});
    await lit.update();
    let most = 0, meshes = 0;
    scene.traverse((mesh) => {
        if (!mesh.isMesh)
            return;
        most = mesh.geometry.getAttribute('color').array.reduce((all, value) => Math.max(all, value), most);
        ++meshes;
    });
    assert.ok(meshes > 1 && most > 0.95 && most < 1.02, `${meshes} meshes, ${most}`);
    await assert.rejects(Relighter.open('no such file.relight'), {code: 'WRONG_FILE', message: /no such file.relight: cannot read: ENOENT/});
});
