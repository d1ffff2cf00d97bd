// The runtime in WebAssembly gives what the native one gives from the same file:
//     node relight_test.mjs PACKAGE SCENE LIGHT_SCENE
// PACKAGE: the folder of relumine.js; SCENE: a file of `export runtime`; LIGHT_SCENE: the program of light_scene.c.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {after, test} from 'node:test';
import {pathToFileURL} from 'node:url';

const [folder, scene, lightScene] = process.argv.slice(2);
const {Relighter, RelighterWorker, RelumineError} = await import(pathToFileURL(path.resolve(folder, 'relumine.js')));
// Fine enough for maps to be turned by vectors (cubemap/rotation.cpp).
const resolution = 144;
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), 'relumine-web-'));
after(() => fs.rmSync(scratch, {recursive: true}));

/** Noise under a brighter light, the same at each run. */
function environment() {
    let state = 1;
    const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
    const map = Float32Array.from({length: 18 * resolution ** 2}, () => next() ** 4);
    for (let x = 10; x < 20; ++x)
        map[3 * (4 * resolution ** 2 + 12 * resolution + x)] = 40;
    return map;
}

/** What the native program writes, one step after the other. */
function native(map) {
    const input = path.join(scratch, 'map.f32'), output = path.join(scratch, 'out.f32');
    fs.writeFileSync(input, map);
    execFileSync(lightScene, [scene, input, String(resolution), output], {stdio: 'inherit'});
    const bytes = fs.readFileSync(output);
    let at = 0;
    return (count) => {
        const numbers = new Float32Array(bytes.buffer, bytes.byteOffset + at, count);
        at += 4 * count;
        return {numbers, isLast: at === bytes.length};
    };
}

function assertEqual(got, {numbers: expected}, step) {
    assert.equal(got.length, expected.length);
    const largest = expected.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    assert.ok(largest > 0.1, `${step}: expected light`);
    let error = 0;
    got.forEach((value, i) => { error = Math.max(error, Math.abs(value - expected[i])); });
    assert.ok(error <= 1e-5 * largest, `${step}: expected an error of 1e-5, got ${error / largest}`);
}

test('radiance is the native one after each step', async () => {
    const map = environment();
    const take = native(map);
    const relighter = await Relighter.open(fs.readFileSync(scene), {harmonics: 3});
    const count = 3 * relighter.info.numReceivers;
    relighter.light({cubeMap: map});
    assertEqual(relighter.radiance(), take(count), 'light');
    const bright = map.map((value, i) => (i < 3 * 7 * 4 ? Math.fround(10 * value) : value));
    relighter.update(2, 3, 5, 7, 4, bright.subarray(0, 3 * 7 * 4));
    assertEqual(relighter.radiance(), take(count), 'update');
    relighter.turn(58);
    assertEqual(relighter.radiance(), take(count), 'turn');
    relighter.turn(20, {resolution: resolution / 2});
    assert.equal(relighter.resolution, resolution / 2);
    assertEqual(relighter.radiance(), take(count), 'coarse turn');
    assertEqual(relighter.harmonics(), take(9 * count), 'harmonics');
    relighter.bounce();
    assertEqual(relighter.radiance(), take(count), 'bounce');
    relighter.light({latLong: bright.subarray(0, 6 * resolution ** 2), width: 2 * resolution, height: resolution});
    const last = take(count);
    assertEqual(relighter.radiance(), last, 'latLong');
    assert.ok(last.isLast);
    relighter.dispose();
});

test('geometry is that of a mesh', async () => {
    const relighter = await Relighter.open(pathToFileURL(path.resolve(scene)));
    const {numReceivers, numTriangles, kind, hasBounces} = relighter.info;
    assert.equal(kind, 'vertices');
    assert.equal(hasBounces, true);
    const normals = relighter.normals(), triangles = relighter.triangles();
    assert.equal(relighter.positions().length, 3 * numReceivers);
    assert.equal(triangles.length, 3 * numTriangles);
    assert.equal(triangles.reduce((most, vertex) => Math.max(most, vertex), 0), numReceivers - 1);
    for (let i = 0; i < numReceivers; ++i)
        assert.ok(Math.abs(Math.hypot(...normals.subarray(3 * i, 3 * i + 3)) - 1) < 1e-5);
    relighter.dispose();
});

test('halves are radiance, and arrays are filled in place', async () => {
    const relighter = await Relighter.open(fs.readFileSync(scene).buffer.slice(0));
    relighter.light({lights: [{direction: [0, 1, 0], irradiance: [3, 3, 3]}]});
    const radiance = relighter.radiance();
    const into = new Float32Array(radiance.length);
    assert.equal(relighter.radiance(into), into);
    assert.deepEqual(into, radiance);
    const half = relighter.radianceHalf();
    half.forEach((bits, i) => {
        const value = bits < 1024 ? bits * 2 ** -24 : (1024 + (bits & 1023)) * 2 ** ((bits >> 10) - 25);
        assert.ok(Math.abs(value - radiance[i]) <= 2 ** -11 * radiance[i] + 2 ** -25);
    });
    relighter.dispose();
});

/** The solid angle of a texel of a cube map: corners' angles, Manne's formula. */
function solidAngle(x, y, resolution) {
    const corner = (i, j) => {
        const [u, v] = [2 * i / resolution - 1, 2 * j / resolution - 1];
        return Math.atan2(u * v, Math.sqrt(u * u + v * v + 1));
    };
    return corner(x, y) - corner(x + 1, y) - corner(x, y + 1) + corner(x + 1, y + 1);
}

test('what lights a point adds up to its radiance', async () => {
    const relighter = await Relighter.open(fs.readFileSync(scene));
    assert.equal(relighter.resolution, 0);
    const map = environment();
    relighter.light({cubeMap: map});
    assert.equal(relighter.resolution, resolution);
    assert.deepEqual(relighter.environment(), map);
    relighter.update(4, 1, 2, 1, 1, [7, 8, 9]);
    assert.deepEqual([...relighter.environment().subarray(3 * (4 * resolution ** 2 + 2 * resolution + 1)).subarray(0, 3)], [7, 8, 9]);
    const radiance = relighter.radiance();
    for (const receiver of [0, 100, relighter.info.numReceivers - 1]) {
        const texels = relighter.contribution(receiver);
        let sum = 0;
        for (let i = 0; i < texels.length / 3; ++i)
            sum += texels[3 * i] * solidAngle(i % resolution, Math.floor(i / resolution) % resolution, resolution);
        assert.ok(Math.abs(sum - radiance[3 * receiver]) < 1e-3 * radiance[3 * receiver] + 1e-6, `${sum}, ${radiance[3 * receiver]}`);
    }
    assert.throws(() => relighter.contribution(relighter.info.numReceivers), {message: /receiver: expected less than/});
    relighter.dispose();
});

test('points see the sky above, and none of it below a floor', async () => {
    const relighter = await Relighter.open(fs.readFileSync(scene));
    const worker = await RelighterWorker.open(pathToFileURL(path.resolve(scene)));
    const directions = [0, 1, 0, 1, 0.3, 0, 0, -1, 0];
    const parts = relighter.visibleParts(directions, 0.2);
    assert.equal(parts.length, 3 * relighter.info.numReceivers);
    assert.deepEqual(await worker.visibleParts(directions, 0.2), parts);
    assert.deepEqual(relighter.visibleParts(directions, 0.2, {numReceivers: 9}), parts.slice(0, 27));
    const of = (direction) => parts.filter((_, i) => i % 3 === direction);
    assert.ok(of(0).some((part) => part === 255) && of(0).some((part) => part === 0));
    assert.ok(of(1).some((part) => part > 0 && part < 255), 'the horizon of some goes through a cone');
    const last = relighter.info.numReceivers - 1;
    assert.deepEqual([...parts.subarray(3 * last)].map((part) => part > 0), [true, true, false], 'a corner of the floor');
    assert.throws(() => relighter.visibleParts([1, 0, 0, 1], 0.2), {message: /directions: expected 3 numbers, got 4/});
    assert.throws(() => relighter.visibleParts([1, 0, 0], 7), {message: /radius/});
    relighter.dispose();
    await worker.dispose();
});

test('a worker gives the same, in the order of calls', async () => {
    const map = environment();
    const relighter = await Relighter.open(fs.readFileSync(scene));
    const worker = await RelighterWorker.open(pathToFileURL(path.resolve(scene)));
    assert.deepEqual(worker.info, relighter.info);
    relighter.light({cubeMap: map});
    const before = relighter.radiance();
    relighter.turn(20);
    worker.light({cubeMap: map});
    const first = worker.radiance();
    worker.turn(20);
    const into = new Float32Array(before.length);
    const second = worker.radiance(into);
    assert.equal(into.length, 0); // handed over
    assert.deepEqual(await first, before);
    assert.deepEqual(await second, relighter.radiance());
    assert.equal(await worker.resolution(), resolution);
    assert.deepEqual(await worker.triangles(), relighter.triangles());
    await assert.rejects(worker.update(9, 0, 0, 1, 1, [1, 1, 1]),
                         {name: 'RelumineError', code: 'WRONG_ARGUMENT', message: /face: expected/});
    await assert.rejects(RelighterWorker.open(new Uint8Array(4)), {code: 'WRONG_FILE'});
    worker.dispose();
    await assert.rejects(worker.radiance(), {message: /after dispose/});
    relighter.dispose();
});

test('what is wrong is said in one sentence', async () => {
    const bytes = fs.readFileSync(scene);
    const rejects = (source, code, message) =>
        assert.rejects(Relighter.open(source), (error) => {
            assert.ok(error instanceof RelumineError, error);
            assert.equal(error.code, code);
            assert.match(error.message, message);
            return true;
        });
    await rejects(new Uint8Array([1, 2, 3]), 'WRONG_FILE', /memory: expected/);
    await rejects(bytes.subarray(0, bytes.length / 2), 'WRONG_FILE', /memory: expected/);
    const wrong = path.join(scratch, 'wrong.prt');
    fs.writeFileSync(wrong, 'no scene');
    await rejects(wrong, 'WRONG_FILE', /wrong\.prt: expected/);
    await rejects(7, 'WRONG_ARGUMENT', /expected a URL/);
    const damaged = Uint8Array.from(bytes);
    damaged[bytes.length >> 1] ^= 16;
    await rejects(damaged, 'WRONG_FILE', /checksum|damaged/);
    await assert.rejects(Relighter.open(bytes, {wasm: new Uint8Array([0, 1])}), /relumine.wasm: expected WebAssembly with SIMD/);

    const relighter = await Relighter.open(bytes);
    const throws = (work, code, message) => assert.throws(work, {name: 'RelumineError', code, message});
    throws(() => relighter.radiance(), 'NOT_LIT', /expected a scene with light/);
    throws(() => relighter.harmonics(), 'NOT_LIT', /expected a scene with light/);
    throws(() => relighter.light({}), 'WRONG_ARGUMENT', /expected one of cubeMap, latLong and lights/);
    throws(() => relighter.light({cubeMap: new Float32Array(17)}), 'WRONG_ARGUMENT', /cubeMap: expected/);
    throws(() => relighter.light({cubeMap: new Float32Array(18).fill(NaN)}), 'WRONG_ARGUMENT', /finite radiance/);
    throws(() => relighter.light({cubeMap: new Uint8Array(18).fill(1)}), 'WRONG_ARGUMENT', /cubeMap: expected floats, got a Uint8Array/);
    throws(() => relighter.light({latLong: new Uint16Array(24), width: 4, height: 2}), 'WRONG_ARGUMENT', /latLong: expected floats, got a Uint16Array/);
    throws(() => relighter.light({latLong: new Float32Array(24), width: 2, height: 4}), 'WRONG_ARGUMENT',
           /width of twice the height, got 2 x 4/);
    relighter.light({cubeMap: new Float32Array(18).fill(1)});
    throws(() => relighter.update(6, 0, 0, 1, 1, [1, 1, 1]), 'WRONG_ARGUMENT', /face: expected 0 to 5/);
    throws(() => relighter.update(0, 0, 0, 2, 1, [1, 1, 1]), 'WRONG_ARGUMENT', /rgb: expected 6 numbers, got 3/);
    throws(() => relighter.update(0, -1, 0, 1, 1, [1, 1, 1]), 'WRONG_ARGUMENT', /x: expected a whole number/);
    throws(() => relighter.radiance(new Float32Array(3)), 'WRONG_ARGUMENT', /Float32Array of \d+ numbers to fill, got Float32Array of 3/);
    throws(() => relighter.harmonics(), 'NOT_THERE', /opened with harmonics/);
    throws(() => relighter.places(), 'NOT_THERE', /vertices/);
    relighter.dispose();
    relighter.dispose();
    throws(() => relighter.radiance(), 'WRONG_ARGUMENT', /after dispose/);
});
