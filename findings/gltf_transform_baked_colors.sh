#!/usr/bin/env bash
# gltf-transform: compression cuts light that was baked into vertices off at 1, or takes its shadows away.
#
# Expected: colours of vertices stay as fine as eyes need, or as they are: COLOR_0 is linear light, and floats may be above 1.
# Found:    quantize() and meshopt() make bytes of linear light: 50 becomes 1, 0.001 becomes 0, 0.002 twice as bright. draco()
#           has 8 bits between the least and the largest number: beside a lamp of 50 everything below 0.098 is 0, and 0.1
#           is 0.196. Nothing is said. `gltf-transform optimize` runs one of them.
# Tried:    @gltf-transform/core, extensions and functions 4.5.1, draco3d 1.5.7, meshoptimizer 1.3.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/{core,extensions,functions}@4.5.1 draco3d@1.5.7 meshoptimizer@1.3.0
cat >colors.mjs <<'JAVASCRIPT'
import { Document, NodeIO, Logger } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { draco, meshopt, quantize } from '@gltf-transform/functions';
import draco3d from 'draco3d';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'draco3d.encoder': await draco3d.createEncoderModule(), 'draco3d.decoder': await draco3d.createDecoderModule(),
    'meshopt.encoder': MeshoptEncoder, 'meshopt.decoder': MeshoptDecoder });

/** All values that the grey light of a strip's vertices has behind a function of gltf-transform, a file and its reader. */
async function behind(transform, light) {
    const document = new Document().setLogger(new Logger(Logger.Verbosity.WARN)), buffer = document.createBuffer();
    const accessor = (type, array) => document.createAccessor().setType(type).setBuffer(buffer).setArray(array);
    const triangles = light.slice(2).flatMap((_, i) => [i, i + 1, i + 2]);
    const primitive = document.createPrimitive().setMaterial(document.createMaterial())
        .setAttribute('POSITION', accessor('VEC3', new Float32Array(light.flatMap((_, i) => [i % 2, i, 0]))))
        .setAttribute('COLOR_0', accessor('VEC3', new Float32Array(light.flatMap((x) => [x, x, x]))))
        .setIndices(accessor('SCALAR', new Uint16Array(triangles)));
    document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
    await document.transform(transform);
    const read = await io.readBinary(await io.writeBinary(document));
    const colors = read.getRoot().listMeshes()[0].listPrimitives()[0].getAttribute('COLOR_0');
    const all = Array.from({ length: colors.getCount() }, (_, i) => colors.getElement(i, [])[0]);
    return [...new Set(all)].sort((a, b) => a - b);
}

const light = [0, 0.001, 0.002, 0.03, 0.1, 1, 50], found = {};
for (const [name, transform] of Object.entries({ quantize: quantize(), meshopt: meshopt({ encoder: MeshoptEncoder }),
    draco: draco() })) {
    found[name] = await behind(transform, light);
    console.log('found:', name, found[name].map((x) => x.toFixed(4)).join(' '), 'for', light.join(' '));
}
const near = (list, expected) => list.length === expected.length && list.every((x, i) => Math.abs(x - expected[i]) < 1e-3);
const bytes = [0, 1, 8, 26, 255].map((byte) => byte / 255), steps = [0, 1, 5, 255].map((step) => step * 50 / 255);
if (!near(found.quantize, bytes) || !near(found.meshopt, bytes) || !near(found.draco, steps)) process.exit(1);
JAVASCRIPT
node colors.mjs
