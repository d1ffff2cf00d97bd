#!/usr/bin/env bash
# bpy (glTF exporter): a clear coat of Blender's default roughness is exported as a perfect mirror.
#
# Expected: Coat Roughness is clearcoatRoughnessFactor, whatever it is.
# Found:    0.03, with which every Principled BSDF begins, is left out of the file, where 0 counts then. 0.02 and 0.04
#           are written. A file whose coat has 0.03 loses it by import and export: highlights get smaller and brighter.
# Tried:    bpy 4.5.15 (exporter 4.5.51) and 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.15
cat >coat.py <<'PYTHON'
import json
import os

import bpy


def exported(roughness):
    """The extension of a coat of this roughness; None is Blender's default."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=1)
    material = bpy.data.materials.new("coat")
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Coat Weight"].default_value = 1
    if roughness is not None:
        inputs["Coat Roughness"].default_value = roughness
    in_blender = inputs["Coat Roughness"].default_value
    bpy.context.object.data.materials.append(material)
    path = os.path.abspath("coat.gltf")
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE")
    with open(path) as file:
        return in_blender, json.load(file)["materials"][0]["extensions"]["KHR_materials_clearcoat"]


for roughness in (None, 0.02, 0.04):
    in_blender, extension = exported(roughness)
    print("found:", round(in_blender, 6), extension)
    if roughness is None:
        assert abs(in_blender - 0.03) < 1e-6 and "clearcoatRoughnessFactor" not in extension
    else:
        assert abs(extension["clearcoatRoughnessFactor"] - roughness) < 1e-6
print("held")
PYTHON
venv/bin/python coat.py | grep -E "found|held"
