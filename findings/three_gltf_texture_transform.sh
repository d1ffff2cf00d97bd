#!/usr/bin/env bash
# three.js (GLTFLoader): textures that are turned and scaled by unequal factors are sheared.
#
# Expected: KHR_texture_transform scales uvs, turns them, then moves them.
# Found:    offset, rotation and scale go into Texture.offset, rotation and repeat one by one, and three.js turns first and
#           scales afterwards. With equal factors or without a turn both are the same. Wood of scale 4, 1 that is turned by 45
#           degrees stands at the corners 2.828 0.707 in place of 0.707 0.707: sheared, with grain four times as dense.
# Tried:    three 0.187.0, node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund three@0.187.0
cat >transform.mjs <<'JS'
import assert from "assert";
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

globalThis.ProgressEvent = class {}; // a browser has it

/** What three.js makes of a texture's transform: the place in the picture of a uv. */
async function places(transform, uvs) {
    const gltf = {
        asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], extensionsUsed: ["KHR_texture_transform"],
        meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, material: 0 }] }],
        materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0, extensions: { KHR_texture_transform: transform } } } }],
        textures: [{ source: 0 }], images: [{ uri: "none.png" }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
                    { bufferView: 1, componentType: 5126, count: 3, type: "VEC2" }],
        bufferViews: [{ buffer: 0, byteLength: 36 }, { buffer: 0, byteOffset: 36, byteLength: 24 }],
        buffers: [{ byteLength: 60, uri: "data:application/octet-stream;base64," +
            Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1]).buffer).toString("base64") }],
    };
    const loader = new GLTFLoader();
    loader.register(() => ({ name: "picture", loadTexture: async () => new THREE.Texture() })); // no picture is decoded
    const { scene } = await loader.parseAsync(JSON.stringify(gltf), "");
    let map;
    scene.traverse((object) => (map = object.material?.map ?? map));
    map.updateMatrix();
    return uvs.map(([u, v]) => new THREE.Vector2(u, v).applyMatrix3(map.matrix).toArray());
}

/** KHR_texture_transform: translation times rotation times scale. */
function expected({ offset: [x, y], rotation, scale: [sx, sy] }, uvs) {
    const c = Math.cos(rotation), s = Math.sin(rotation);
    return uvs.map(([u, v]) => [c * sx * u + s * sy * v + x, -s * sx * u + c * sy * v + y]);
}

const uvs = [[0, 0], [1, 0], [0, 1]];
const difference = async (transform) => {
    const got = await places(transform, uvs), wanted = expected(transform, uvs);
    const round = (list) => JSON.stringify(list.map((one) => one.map((x) => +x.toFixed(3))));
    console.log("found:", JSON.stringify(transform), "- specification", round(wanted), "- three.js", round(got));
    return Math.max(...got.flat().map((x, i) => Math.abs(x - wanted.flat()[i])));
};
assert((await difference({ offset: [0.1, 0.2], rotation: 0.5, scale: [2, 2] })) < 1e-6);
assert((await difference({ offset: [0.1, 0.2], rotation: 0, scale: [4, 1] })) < 1e-6);
const sheared = await difference({ offset: [0, 0], rotation: Math.PI / 4, scale: [4, 1] });
assert(sheared > 2 && sheared < 2.2);
console.log("held");
JS
node transform.mjs
