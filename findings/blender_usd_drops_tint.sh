#!/usr/bin/env bash
# bpy (USD exporter): a picture times a colour is written as the picture alone.
#
# Expected: what Multiply makes of a texture and a colour reaches UsdPreviewSurface: UsdUVTexture has `inputs:scale` for it.
#           Blender's glTF exporter writes the same scene as baseColorTexture and baseColorFactor.
# Found:    diffuseColor is the texture, and the colour is gone without a message. So is the colour of vertices
#           (Color Attribute) that a texture is multiplied with. Tinted variants of one texture all look alike, and glTF's
#           factors are lost on the way glTF, Blender, USD.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11. So does bpy 5.2.3.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >tint.py <<'PYTHON'
import json
import os

import bpy

bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdShade

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add()
material = bpy.data.materials.new("look")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
picture = nodes.new("ShaderNodeTexImage")
picture.image = bpy.data.images.new("picture", 4, 4)
picture.image.filepath_raw, picture.image.file_format = os.path.abspath("picture.png"), "PNG"
picture.image.save()
tint = nodes.new("ShaderNodeMix")
tint.data_type, tint.blend_type = "RGBA", "MULTIPLY"
tint.inputs["Factor"].default_value = 1.0
color = lambda sockets, name: [s for s in sockets if s.name == name and s.type == "RGBA"][0]
links.new(picture.outputs["Color"], color(tint.inputs, "A"))
color(tint.inputs, "B").default_value = (1.0, 0.1, 0.0, 1.0)
links.new(color(tint.outputs, "Result"), nodes["Principled BSDF"].inputs["Base Color"])
bpy.context.object.data.materials.append(material)

bpy.ops.export_scene.gltf(filepath=os.path.abspath("plane.gltf"), export_format="GLTF_SEPARATE")


factor = json.load(open("plane.gltf"))["materials"][0]["pbrMetallicRoughness"]
print("found: glTF of the same scene:", factor)
bpy.ops.wm.usd_export(filepath=os.path.abspath("plane.usda"))
stage = Usd.Stage.Open("plane.usda")
inputs = {}
for prim in stage.Traverse():
    if prim.IsA(UsdShade.Shader):
        shader = UsdShade.Shader(prim)
        for i in shader.GetInputs():
            source = i.GetConnectedSource() if i.HasConnectedSource() else None
            inputs[f"{prim.GetName()}.{i.GetBaseName()}"] = source[0].GetPrim().GetName() if source else i.Get()
print("found: USD:", {k: v for k, v in inputs.items() if "diffuse" in k or "scale" in k or "Mix" in k})
assert inputs["Principled_BSDF.diffuseColor"] == "Image_Texture"
assert not any("scale" in key or "Mix" in key for key in inputs)
print("held")
PYTHON
venv/bin/python tint.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
