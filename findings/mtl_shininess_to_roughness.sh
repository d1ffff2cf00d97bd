#!/usr/bin/env bash
# Converters from MTL to metallic-roughness make three different roughnesses of one Ns.
#
# Expected: a highlight keeps its size, roughly: an exponent of 100 is a roughness near 0.37, the fourth root of 2 / (Ns + 2).
# Found:    Ns 100 is 0.37 in trimesh, 0.68 in Blender, 1 - sqrt(Ns / 1000), and 0.9 in obj2gltf, 1 - Ns / 1000. The lobe's width
#           goes with the square: six times wider in obj2gltf than in trimesh, so a polished floor is matt. At Ns 900 the
#           order is the other way: 0.22, 0.05, 0.1. So there is no roughness by which a file looks alike in all three.
# Tried:    trimesh 5.2.0, bpy 5.0.1 of PyPI, Python 3.11; obj2gltf 3.2.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund obj2gltf@3.2.0
python3.11 -m venv venv
venv/bin/pip install -q trimesh==5.2.0 bpy==5.0.1
printf 'mtllib shiny.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n' >shiny.obj
for exponent in 10 100 900; do
    printf 'newmtl n%d\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs %d\n' "$exponent" "$exponent" >>shiny.mtl
    printf 'o n%d\nusemtl n%d\nf 1 2 3\n' "$exponent" "$exponent" >>shiny.obj
done
cat >obj2gltf.mjs <<'JAVASCRIPT'
import obj2gltf from 'obj2gltf';

const { materials } = await obj2gltf('shiny.obj');
console.log(JSON.stringify(materials.map((material) => material.pbrMetallicRoughness.roughnessFactor)));
JAVASCRIPT
node obj2gltf.mjs >obj2gltf.json
cat >shiny.py <<'PYTHON'
import json
import os

import bpy
import trimesh

names = ("n10", "n100", "n900")
with open("obj2gltf.json") as file:
    found = {"obj2gltf": json.load(file)}
scene = trimesh.load("shiny.obj", split_object=True)
materials = {m.name: m for m in (geometry.visual.material for geometry in scene.geometry.values())}
found["trimesh"] = [float(materials[name].to_pbr().roughnessFactor) for name in names]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=os.path.abspath("shiny.obj"))
found["Blender"] = [bpy.data.materials[name].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value for name in names]
expected = {"obj2gltf": [0.99, 0.9, 0.1], "trimesh": [0.639, 0.374, 0.217], "Blender": [0.9, 0.684, 0.051]}
for name, values in found.items():
    print("found: Ns 10, 100, 900:", name, [round(x, 3) for x in values])
    assert all(abs(x - y) < 0.002 for x, y in zip(values, expected[name]))
PYTHON
venv/bin/python shiny.py 2>log | grep "^found: " || { tail -5 log; exit 1; }
