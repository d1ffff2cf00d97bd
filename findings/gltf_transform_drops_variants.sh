#!/usr/bin/env bash
# gltf-transform: dedup() and join() drop variants of materials.
#
# Expected: two meshes of equal shape and material, one of which is red in the variant "red" (KHR_materials_variants),
#           keep that: the library reads and writes the extension.
# Found:    dedup() takes the two for copies of each other and keeps the one without the variant. join() makes one
#           primitive of both, without it. Nothing is said. `gltf-transform optimize` runs both. weld() keeps it.
# Tried:    @gltf-transform/core, extensions and functions 4.5.1 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/{core,extensions,functions}@4.5.1
cat >variants.mjs <<'JAVASCRIPT'
import { Document } from '@gltf-transform/core';
import { KHRMaterialsVariants } from '@gltf-transform/extensions';
import { dedup, join, weld } from '@gltf-transform/functions';

/** Two triangles side by side; the second one is red in a variant. */
function twoTriangles() {
    const document = new Document();
    document.createBuffer();
    document.setLogger({ debug() {}, info() {}, warn: console.log, error: console.error });
    const scene = document.createScene(), grey = document.createMaterial('grey'), red = document.createMaterial('red');
    const variants = document.createExtension(KHRMaterialsVariants), name = variants.createVariant('red');
    for (const isRed of [false, true]) {
        const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
        const primitive = document.createPrimitive().setMaterial(grey)
            .setAttribute('POSITION', document.createAccessor().setType('VEC3').setArray(corners));
        if (isRed)
            primitive.setExtension('KHR_materials_variants', variants.createMappingList()
                .addMapping(variants.createMapping().setMaterial(red).addVariant(name)));
        const mesh = document.createMesh(isRed ? 'b' : 'a').addPrimitive(primitive);
        scene.addChild(document.createNode().setMesh(mesh).setTranslation([isRed ? 1 : 0, 0, 0]));
    }
    return document;
}
/** Primitives in the scene that know a variant. */
function withVariants(document) {
    return document.getRoot().listNodes().flatMap((node) => node.getMesh()?.listPrimitives() ?? [])
        .filter((primitive) => primitive.getExtension('KHR_materials_variants')?.listMappings().length).length;
}
for (const [name, operation, expected] of [['weld', weld(), 1], ['dedup', dedup(), 0], ['join', join(), 0]]) {
    const document = twoTriangles();
    await document.transform(operation);
    console.log('found:', name, 'leaves', withVariants(document), 'of 1 surfaces with variants');
    if (withVariants(document) !== expected) process.exit(1);
}
JAVASCRIPT
node variants.mjs
