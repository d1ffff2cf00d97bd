#!/usr/bin/env bash
# three.js USDZExporter: a lamp's glow loses its intensity, lights vanish, and many copies become one.
#
# Expected: emissiveColor is the emission times emissiveIntensity, as GLTFExporter writes it by KHR_materials_emissive_strength.
#           Lights become UsdLux or are named in a warning; so are the copies of an InstancedMesh.
# Found:    an emission of 1, 0.5, 0.25 with intensity 30 is written as 1, 0.5, 0.25. A map of emission is multiplied by the
#           intensity, so the two differ by 30. Lights become empty nodes, three copies become one, transmission 1 becomes
#           opacity 1. The only warning is about materials that are not MeshStandardMaterial.
# Tried:    three 0.187.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat >lamp.mjs <<'JAVASCRIPT'
import * as THREE from 'three';
import { USDZExporter } from 'three/examples/jsm/exporters/USDZExporter.js';
import { strFromU8, unzipSync } from 'three/examples/jsm/libs/fflate.module.js';

const said = [];
console.warn = (...words) => said.push(words.join(' '));
const scene = new THREE.Scene(), plane = new THREE.PlaneGeometry();
scene.add(new THREE.Mesh(plane, new THREE.MeshStandardMaterial({ emissive: new THREE.Color(1, 0.5, 0.25), emissiveIntensity: 30 })),
    new THREE.Mesh(plane, new THREE.MeshPhysicalMaterial({ transmission: 1, ior: 1.33 })),
    new THREE.InstancedMesh(plane, new THREE.MeshStandardMaterial(), 3), new THREE.PointLight(0xffffff, 10),
    new THREE.DirectionalLight(0xffffff, 3));
const files = unzipSync(await new USDZExporter().parseAsync(scene));
const text = Object.values(files).map((file) => strFromU8(file)).join('\n');
const count = (pattern) => (text.match(pattern) ?? []).length;
const found = {
    emissive: text.match(/inputs:emissiveColor = (.*)/)[1], meshes: count(/prepend references = @.\/geometries/g),
    lights: count(/\w*Light\b/g), transparent: count(/opacity = 0/g), warnings: said,
};
console.log('found:', found);
if (found.emissive !== '(1, 0.5, 0.25)' || found.meshes !== 3 || found.lights || found.transparent || said.length) process.exit(1);
JAVASCRIPT
node lamp.mjs
