#!/usr/bin/env bash
# bpy (USD importer): a picture that gives a colour and an opacity loses its sRGB, so the colour is too light.
#
# Expected: two UsdUVTexture nodes read one PNG: the colour with sourceColorSpace sRGB, the opacity of its alpha with raw. So
#           a byte of 182 is 0.47 of light in the colour. Blender's own exporter writes such pairs.
# Found:    both nodes share one image, which has the colour space of the node that was read last: Non-Color. The byte of 182
#           is 0.71 of light. Without the opacity, or with a copy of the file for it, the image is sRGB.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >shared.py <<'PYTHON'
import os
import shutil

import bpy

TEXTURE = """
    def Shader "%s" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./%s@
        token inputs:sourceColorSpace = "%s"
        float2 inputs:st.connect = </Look/Uv.outputs:result>
        float3 outputs:rgb
        float outputs:a
    }
"""
STAGE = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def Mesh "Card" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
    rel material:binding = </Look>
}
def Material "Look" {
    token outputs:surface.connect = </Look/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </Look/Color.outputs:rgb>
        OPACITY
        token outputs:surface
    }
    def Shader "Uv" {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
    TEXTURES
}
"""


def color_space(opacity):
    """That of the image behind the base colour."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    textures = TEXTURE % ("Color", "a.png", "sRGB")
    if opacity:
        textures += TEXTURE % ("Alpha", opacity, "raw")
    connect = "float inputs:opacity.connect = </Look/Alpha.outputs:a>" if opacity else ""
    with open("a.usda", "w") as file:
        file.write(STAGE.replace("OPACITY", connect).replace("TEXTURES", textures))
    bpy.ops.wm.usd_import(filepath=os.path.abspath("a.usda"))
    shader = next(n for n in bpy.data.materials["Look"].node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    return shader.inputs["Base Color"].links[0].from_node.image.colorspace_settings.name


image = bpy.data.images.new("a", 2, 2, alpha=True)
image.file_format = "PNG"
image.filepath_raw = os.path.abspath("a.png")
image.save()
shutil.copy("a.png", "b.png")
found = [color_space(None), color_space("b.png"), color_space("a.png")]
print("found: colour alone", found[0], "- opacity of a copy", found[1], "- of the same file", found[2])
assert found == ["sRGB", "sRGB", "Non-Color"]
print("held")
PYTHON
venv/bin/python shared.py | grep -E "found|held"
