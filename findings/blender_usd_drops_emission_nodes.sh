#!/usr/bin/env bash
# bpy (USD exporter): the light of Emission nodes is lost: panels go out, and lamps lose colour and strength.
#
# Expected: a mesh whose material is an Emission shader has that light as emissiveColor, as Blender's glTF exporter writes it,
#           and a lamp's Emission node, which multiplies its light, counts as well. Or a line says that it does not.
# Found:    the material is written without a shader, so the panel is grey and dark. A lamp of 10 W whose node has a strength
#           of 7 and red is written as 10 W of white. Nothing is said. A Principled BSDF keeps its emission.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >glow.py <<'PYTHON'
import json
import math
import os

import bpy

bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdLux, UsdShade

bpy.ops.wm.read_factory_settings(use_empty=True)
for name in ("EMISSION", "PRINCIPLED"):
    bpy.ops.mesh.primitive_plane_add()
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    if name == "EMISSION":
        emission = nodes.new("ShaderNodeEmission")
        nodes.remove(nodes["Principled BSDF"])
        material.node_tree.links.new(emission.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
        color, strength = emission.inputs["Color"], emission.inputs["Strength"]
    else:
        color, strength = (nodes["Principled BSDF"].inputs[x] for x in ("Emission Color", "Emission Strength"))
    color.default_value, strength.default_value = (1, 0.5, 0.25, 1), 30
    bpy.context.object.data.materials.append(material)
bpy.ops.export_scene.gltf(filepath=os.path.abspath("glow.gltf"), export_format="GLTF_SEPARATE")
lamp = bpy.data.lights.new("lamp", "POINT")
lamp.energy, lamp.use_nodes = 10, True
lamp.node_tree.nodes["Emission"].inputs["Color"].default_value = (1, 0, 0, 1)
lamp.node_tree.nodes["Emission"].inputs["Strength"].default_value = 7
bpy.context.scene.collection.objects.link(bpy.data.objects.new("lamp", lamp))
bpy.ops.wm.usd_export(filepath=os.path.abspath("glow.usda"))

stage, emitted = Usd.Stage.Open("glow.usda"), {}
for prim in stage.Traverse():
    if prim.IsA(UsdShade.Material):
        shaders = [UsdShade.Shader(child) for child in prim.GetChildren()]
        emitted[prim.GetName()] = [tuple(shader.GetInput("emissiveColor").Get()) for shader in shaders]
    elif prim.IsA(UsdLux.SphereLight):
        light = UsdLux.SphereLight(prim)
        intensity, color = light.GetIntensityAttr().Get(), tuple(light.GetColorAttr().Get())
with open("glow.gltf") as file:
    gltf = {m["name"]: m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] for m in json.load(file)["materials"]}
print("found: USD", emitted, "- glTF", gltf, "- lamp", intensity, color)
assert emitted == {"EMISSION": [], "PRINCIPLED": [(30, 15, 7.5)]} and gltf == {"EMISSION": 30, "PRINCIPLED": 30}
assert math.isclose(intensity, 10 / math.pi, rel_tol=1e-5) and color == (1, 1, 1)
print("held")
PYTHON
venv/bin/python glow.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
