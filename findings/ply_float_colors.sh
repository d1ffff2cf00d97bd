#!/usr/bin/env bash
# Readers of PLY take the same float colours (red, green, blue) of vertices in three ways.
#
# Expected: floats are linear, or at least all readers agree on them.
# Found:    three.js takes them as sRGB and decodes them, also above 1 (2.0 becomes 4.95), and its exporter encodes what
#           it writes. trimesh takes them times 255 as bytes, so 2.0 becomes 255. pymeshlab says that there are none.
# Tried:    three 0.187.0 of npm; trimesh 5.2.0 and pymeshlab 2025.7.post1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install -q trimesh==5.2.0 pymeshlab==2025.7.post1
npm install --silent --no-audit --no-fund three@0.187.0
cat >triangle.ply <<'PLY'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property float red
property float green
property float blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 0.5 0.25 2.0
1 0 0 0.5 0.25 2.0
0 1 0 0.5 0.25 2.0
3 0 1 2
PLY
cat >read.py <<'PYTHON'
import pymeshlab
import trimesh

bytes_of_trimesh = list(map(int, trimesh.load("triangle.ply", process=False).visual.vertex_colors[0][:3]))
meshes = pymeshlab.MeshSet()
meshes.load_new_mesh("triangle.ply")
has_colors = meshes.current_mesh().has_vertex_color()
print("trimesh", bytes_of_trimesh, "pymeshlab", has_colors)
assert bytes_of_trimesh == [128, 64, 255] and not has_colors
PYTHON
cat >read.mjs <<'JAVASCRIPT'
import fs from 'fs';
import * as THREE from 'three';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';

const read = Array.from(new PLYLoader().parse(fs.readFileSync('triangle.ply', 'utf8')).attributes.color.array.slice(0, 3));
const triangle = new THREE.BufferGeometry();
triangle.setAttribute('position', new THREE.Float32BufferAttribute([0, 0, 0, 1, 0, 0, 0, 1, 0], 3));
triangle.setAttribute('color', new THREE.Float32BufferAttribute(Array(9).fill(0.5), 3));
const written = Number(new PLYExporter().parse(new THREE.Mesh(triangle), undefined, {}).split('end_header\n')[1].split(' ')[3]);
console.log('three reads', read, 'and writes', written, 'for 0.5');
const near = (a, b) => Math.abs(a - b) < 1e-4;
if (!near(read[0], 0.21404) || !near(read[2], 4.95385) || !near(written, 0.73536)) process.exit(1);
JAVASCRIPT
venv/bin/python read.py
node read.mjs
