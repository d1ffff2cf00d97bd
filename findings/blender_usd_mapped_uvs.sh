#!/usr/bin/env bash
# bpy (USD exporter): a texture behind a Mapping node asks for uvs that the mesh does not have.
#
# Expected: a texture's UsdPrimvarReader_float2 names the primvar that the exporter gave the mesh.
# Found:    the active uv map is renamed to `st`, and readers of textures that stand alone ask for `st`. The reader below a
#           UsdTransform2d keeps the name in Blender, `UVMap`. The file has no such primvar, so each texture that is scaled,
#           moved or turned is one colour. KHR_texture_transform of glTF becomes a Mapping node on import.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11. So does bpy 5.2.3.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >mapped.py <<'PYTHON'
import os
import sys

import bpy

bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdGeom, UsdShade


def exported(is_mapped):
    """A plane with a picture, through a Mapping node or straight. Returns its uvs' names: those asked for, those there."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add()
    plane = bpy.context.object
    print("found: uv map in Blender:", [layer.name for layer in plane.data.uv_layers])
    material = bpy.data.materials.new("look")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.new("picture", 4, 4)
    picture.image.filepath_raw, picture.image.file_format = os.path.abspath("picture.png"), "PNG"
    picture.image.save()
    links.new(picture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    uvs = nodes.new("ShaderNodeUVMap")
    uvs.uv_map = "UVMap"
    if is_mapped:
        mapping = nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (2, 2, 1)
        links.new(uvs.outputs["UV"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
    else:
        links.new(uvs.outputs["UV"], picture.inputs["Vector"])
    plane.data.materials.append(material)
    bpy.ops.wm.usd_export(filepath=os.path.abspath("plane.usda"))
    stage = Usd.Stage.Open("plane.usda")
    asked, there = set(), set()
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            there |= {p.GetPrimvarName() for p in UsdGeom.PrimvarsAPI(prim).GetPrimvars()}
        if prim.IsA(UsdShade.Shader) and "PrimvarReader" in str(UsdShade.Shader(prim).GetIdAttr().Get()):
            asked.add(UsdShade.Shader(prim).GetInput("varname").Get())
    print("found:", "mapped" if is_mapped else "straight", "asks for", asked, "of", there)
    return asked, there


asked, there = exported(False)
assert asked == {"st"} and "st" in there
asked, there = exported(True)
assert asked == {"UVMap"} and "st" in there and "UVMap" not in there
print("held")
PYTHON
venv/bin/python mapped.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
