#!/usr/bin/env bash
# gltf-transform: an animation of KHR_animation_pointer leaves channels that point nowhere.
#
# Expected: a channel whose path is `pointer` is kept with its pointer, or goes with the extension.
# Found:    the extension is dropped, as a line says, and its channels stay with the path `pointer` and without a target. The
#           file no longer names the extension, so for its readers the path is not glTF: gltf-validator warns where the file
#           before had nothing. Colours, lights and cameras stand still. Any command does so, `copy` as well.
# Tried:    @gltf-transform/cli 4.5.1, gltf-validator 2.0.0-dev.3.10.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund @gltf-transform/cli@4.5.1 gltf-validator@2.0.0-dev.3.10
cat >pointer.mjs <<'JS'
import assert from "assert";
import fs from "fs";
import { execFileSync } from "child_process";
import validator from "gltf-validator";

// A colour that is animated by KHR_animation_pointer, and a turn beside it.
const numbers = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0]);
const view = (first, count) => ({ buffer: 0, byteOffset: 4 * first, byteLength: 4 * count });
const accessor = (bufferView, count, type, more = {}) => ({ bufferView, componentType: 5126, count, type, ...more });
const channel = (sampler, target) => ({ sampler, target });
fs.writeFileSync("lamp.gltf", JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { metallicFactor: 0 } }],
    extensionsUsed: ["KHR_animation_pointer"],
    animations: [{
        samplers: [{ input: 1, output: 2 }, { input: 1, output: 3 }],
        channels: [
            channel(0, { path: "pointer", extensions: { KHR_animation_pointer: { pointer: "/materials/0/pbrMetallicRoughness/baseColorFactor" } } }),
            channel(1, { node: 0, path: "rotation" })],
    }],
    accessors: [accessor(0, 3, "VEC3", { min: [0, 0, 0], max: [1, 1, 0] }), accessor(1, 2, "SCALAR", { min: [0], max: [1] }),
                accessor(2, 2, "VEC4"), accessor(3, 2, "VEC4")],
    bufferViews: [view(0, 9), view(9, 2), view(11, 8), view(19, 8)],
    buffers: [{ byteLength: 108, uri: "data:application/octet-stream;base64," + Buffer.from(numbers.buffer).toString("base64") }],
}));
const errors = async (file) => (await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(uri)) })).issues;
const before = await errors("lamp.gltf");
console.log("found: before:", before.numErrors, "errors,", before.numWarnings, "warnings");
console.log("found:", execFileSync("node_modules/.bin/gltf-transform", ["copy", "lamp.gltf", "copy.gltf"], { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] })
    .split("\n").find((line) => line.includes("KHR")) ?? "no word of the extension");
const after = JSON.parse(fs.readFileSync("copy.gltf", "utf8"));
console.log("found: channels after:", JSON.stringify(after.animations[0].channels), "extensions:", after.extensionsUsed);
assert.deepEqual(after.animations[0].channels[0].target, { path: "pointer" });
assert.equal(after.extensionsUsed, undefined);
const messages = (await errors("copy.gltf")).messages.filter((message) => message.code === "VALUE_NOT_IN_LIST");
console.log("found: validator:", messages.map((message) => message.message + " " + message.pointer).join());
assert.equal(before.numErrors + before.numWarnings, 0);
assert.equal(messages.length, 1);
console.log("held");
JS
node pointer.mjs
