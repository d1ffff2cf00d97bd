#!/usr/bin/env bash
# bpy (glTF exporter): sheen is exported as if its weight were 1.
#
# Expected: sheenColorFactor is the sheen's tint times its weight: a weight of 0.1 and a white tint give 0.1.
# Found:    the weight only switches the extension on, and the tint is written. So a touch of dust, weight 0.05, becomes
#           white velvet, and all weights look alike. What the importer makes of a file, weight 1 and a tint, comes back.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11. bpy 5.2.3 does the same.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >sheen.py <<'PYTHON'
import json

import bpy


def exported(weight):
    """The colour of the sheen that the exporter writes for a weight and a white tint."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("triangle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("triangle", mesh))
    material = bpy.data.materials.new("surface")
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Sheen Weight"].default_value = weight
    mesh.materials.append(material)
    bpy.ops.export_scene.gltf(filepath="out.gltf", export_format="GLTF_SEPARATE")
    with open("out.gltf") as file:
        extensions = json.load(file)["materials"][0].get("extensions", {})
    return extensions.get("KHR_materials_sheen", {}).get("sheenColorFactor")


found = {weight: exported(weight) for weight in (0.0, 0.05, 0.5, 1.0)}
print("found:", found)
assert found[0.0] is None and found[0.05] == found[0.5] == found[1.0] == [1, 1, 1]
PYTHON
venv/bin/python sheen.py >log 2>&1 || { tail -20 log; exit 1; }
grep found: log
