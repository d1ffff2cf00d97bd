#!/usr/bin/env bash
# gltf-transform: flatten(), join() and instance() show what KHR_node_visibility hides.
#
# Expected: a hidden node's mesh, and what hangs below a hidden node, stay hidden. The library reads and writes the
#           extension, and these operations keep the picture.
# Found:    flatten() takes the child of a hidden node to the top, where nothing hides it. join() puts a hidden mesh
#           into a visible one. instance() makes instances of hidden nodes as well. All three leave an empty hidden
#           node behind. `gltf-transform optimize` runs them by itself.
# Tried:    @gltf-transform/core, extensions and functions 4.5.1 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/{core,extensions,functions}@4.5.1
cat >hidden.mjs <<'JAVASCRIPT'
import { Document } from '@gltf-transform/core';
import { KHRNodeVisibility } from '@gltf-transform/extensions';
import { flatten, instance, join } from '@gltf-transform/functions';

/** A document, its scene, a maker of meshes of one triangle and what hides a node. */
function empty() {
    const document = new Document();
    document.createBuffer();
    const material = document.createMaterial();
    const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    const mesh = () => document.createMesh().addPrimitive(document.createPrimitive().setMaterial(material)
        .setAttribute('POSITION', document.createAccessor().setType('VEC3').setArray(corners)));
    const hidden = document.createExtension(KHRNodeVisibility).createVisibility().setVisible(false);
    document.setLogger({ debug() {}, info() {}, warn() {}, error: console.error });
    return { document, scene: document.createScene(), mesh, hide: (node) => node.setExtension('KHR_node_visibility', hidden) };
}
/** Triangles of nodes that neither are hidden nor below a hidden node. */
function visible(document) {
    let count = 0;
    const visit = (node) => {
        if (node.getExtension('KHR_node_visibility')?.getVisible() === false) return;
        const copies = node.getExtension('EXT_mesh_gpu_instancing')?.getAttribute('TRANSLATION').getCount() ?? 1;
        for (const primitive of node.getMesh()?.listPrimitives() ?? [])
            count += copies * (primitive.getIndices() ?? primitive.getAttribute('POSITION')).getCount() / 3;
        node.listChildren().forEach(visit);
    };
    document.getRoot().listScenes()[0].listChildren().forEach(visit);
    return count;
}
async function found(name, make, operation, before, after) {
    const it = empty();
    make(it);
    const counts = [visible(it.document)];
    await it.document.transform(operation);
    counts.push(visible(it.document));
    console.log('found:', name, 'visible triangles before', counts[0], 'and after', counts[1]);
    if (counts[0] !== before || counts[1] !== after) process.exit(1);
}
await found('flatten', ({ document, scene, mesh, hide }) => {
    const parent = hide(document.createNode('off'));
    scene.addChild(parent.addChild(document.createNode('child').setMesh(mesh())));
}, flatten(), 0, 1);
await found('join', ({ document, scene, mesh, hide }) => {
    scene.addChild(document.createNode('on').setMesh(mesh()));
    scene.addChild(hide(document.createNode('off')).setMesh(mesh()).setTranslation([1, 0, 0]));
}, join(), 1, 2);
await found('instance', ({ document, scene, mesh, hide }) => {
    const shared = mesh();
    for (let i = 0; i < 3; ++i) {
        const node = document.createNode().setMesh(shared).setTranslation([i, 0, 0]);
        scene.addChild(i === 1 ? hide(node) : node);
    }
}, instance({ min: 2 }), 2, 3);
JAVASCRIPT
node hidden.mjs
