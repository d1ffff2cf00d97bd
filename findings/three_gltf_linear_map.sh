#!/usr/bin/env bash
# three.js GLTFExporter: a map of linear colours is written as if it were sRGB, and faces lose which side they show.
#
# Expected: baseColorTexture is sRGB in glTF, so that the bytes of a map in LinearSRGBColorSpace are converted (128
#           becomes 188), or the exporter warns. A material of BackSide is turned, or the exporter warns.
# Found:    the bytes stay, and the file is read with 0.216 in place of 0.502: surfaces are darker by 2.3. BackSide, as
#           rooms and sky domes have it, becomes a plain single-sided material, which shows the other side.
# Tried:    three 0.187.0 and @napi-rs/canvas 0.1 of npm as the browser's canvas, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 @napi-rs/canvas@0.1
cat >map.mjs <<'JAVASCRIPT'
import { Canvas, createCanvas, Image, ImageData, loadImage } from '@napi-rs/canvas';

// What the exporter asks of a browser.
Object.assign(globalThis, { HTMLCanvasElement: Canvas, HTMLImageElement: Image, ImageData, ImageBitmap: Image });
globalThis.document = { createElement: () => Object.assign(createCanvas(1, 1), {
    toBlob(done) { done(new Blob([this.toBuffer('image/png')])); } }) };
globalThis.FileReader = class {
    async readAsDataURL(blob) {
        this.result = `data:image/png;base64,${Buffer.from(await blob.arrayBuffer()).toString('base64')}`;
        this.onloadend();
    }
};
const said = [];
console.warn = (...words) => said.push(words.join(' '));
const THREE = await import('three');
const { GLTFExporter } = await import('three/examples/jsm/exporters/GLTFExporter.js');

const grey = new THREE.DataTexture(new Uint8Array(Array(4).fill([128, 128, 128, 255]).flat()), 2, 2);
grey.colorSpace = THREE.LinearSRGBColorSpace;
grey.needsUpdate = true;
const exported = async (values) => await new GLTFExporter().parseAsync(
    new THREE.Mesh(new THREE.PlaneGeometry(), new THREE.MeshStandardMaterial(values)), { binary: false });
const { images } = await exported({ map: grey });
const context = createCanvas(2, 2).getContext('2d');
context.drawImage(await loadImage(Buffer.from(images[0].uri.split(',')[1], 'base64')), 0, 0);
const [byte] = context.getImageData(0, 0, 1, 1).data;
const { materials, nodes } = await exported({ side: THREE.BackSide });
console.log('found: linear 128 is', byte, 'in the file; BackSide is', JSON.stringify(materials[0]), 'warnings', said);
const is_turned = nodes.some((node) => node.scale || node.matrix) || materials[0].doubleSided;
if (byte !== 128 || is_turned || said.length !== 0) process.exit(1);
JAVASCRIPT
node map.mjs
