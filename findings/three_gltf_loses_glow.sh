#!/usr/bin/env bash
# three.js GLTFExporter: the glow of Lambert and Phong materials loses its intensity, and unlit light makes an invalid file.
#
# Expected: KHR_materials_emissive_strength for whatever has an emissiveIntensity, and for a MeshBasicMaterial whose colour
#           is above 1, which is how lamps are drawn in linear light. Sheen's weight counts in its colour.
# Found:    only MeshStandardMaterial has the extension: an intensity of 10 of the others is 1 in the file, and the exporter
#           merely advises the other material. A colour of 5 is a baseColorFactor of 5, which glTF does not allow and readers
#           cut off. A sheen of weight 0.1 is written as if it were 1.
# Tried:    three 0.187.0, gltf-validator 2.0.0-dev.3.10 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0 gltf-validator@2.0.0-dev.3.10
cat >glow.mjs <<'JAVASCRIPT'
import validator from 'gltf-validator';

globalThis.FileReader = class {
    async readAsDataURL(blob) {
        this.result = `data:application/octet-stream;base64,${Buffer.from(await blob.arrayBuffer()).toString('base64')}`;
        this.onloadend();
    }
};
const said = console.warn;
console.warn = () => {};
const THREE = await import('three');
const { GLTFExporter } = await import('three/examples/jsm/exporters/GLTFExporter.js');

/** The glTF material of a three.js material, and what the validator says of the file. */
async function exported(material) {
    const gltf = await new GLTFExporter().parseAsync(new THREE.Mesh(new THREE.PlaneGeometry(), material), { binary: false });
    const { issues } = await validator.validateString(JSON.stringify(gltf));
    const errors = issues.messages.filter(({ severity }) => severity === 0).map(({ code, pointer }) => `${code} ${pointer}`);
    return { ...gltf.materials[0], errors };
}
const glow = { emissive: 0xffffff, emissiveIntensity: 10 };
const strength = async (Material) =>
    (await exported(new Material(glow))).extensions?.KHR_materials_emissive_strength?.emissiveStrength ?? 1;
const found = {
    standard: await strength(THREE.MeshStandardMaterial), lambert: await strength(THREE.MeshLambertMaterial),
    phong: await strength(THREE.MeshPhongMaterial),
    unlit: await exported(new THREE.MeshBasicMaterial({ color: new THREE.Color(5, 5, 5) })),
    sheen: (await exported(new THREE.MeshPhysicalMaterial({ sheen: 0.1, sheenColor: 0xffffff }))).extensions.KHR_materials_sheen,
};
console.warn = said;
console.log('found:', JSON.stringify(found, null, 1));
if (found.standard !== 10 || found.lambert !== 1 || found.phong !== 1) process.exit(1);
if (found.unlit.pbrMetallicRoughness.baseColorFactor[0] !== 5 || found.unlit.errors.length === 0) process.exit(1);
if (found.sheen.sheenColorFactor.join() !== '1,1,1') process.exit(1);
JAVASCRIPT
node glow.mjs
