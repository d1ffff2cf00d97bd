#!/usr/bin/env bash
# bpy (USD importer): gold of the specular workflow becomes black plastic.
#
# Expected: UsdPreviewSurface with `useSpecularWorkflow` 1 has its reflection in `specularColor`. The importer makes a metal of
#           it, or a specular tint with a high index, as Blender's glTF importer does for KHR_materials_pbrSpecularGlossiness.
# Found:    specularColor becomes a tint and the index stays 1.5: gold of 1, 0.8, 0.3 mirrors 4, 3.2 and 1.2 %, and its
#           diffuseColor is black. Nothing is said. The same surface of a glTF file gets an index of 1,000 and keeps its light.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >gold.usda <<'USD'
#usda 1.0
(
    defaultPrim = "root"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "root"
{
    def Mesh "mesh" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        rel material:binding = </root/gold>
    }
    def Material "gold"
    {
        token outputs:surface.connect = </root/gold/surface.outputs:surface>
        def Shader "surface"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0, 0, 0)
            float inputs:roughness = 0.2
            color3f inputs:specularColor = (1, 0.8, 0.3)
            int inputs:useSpecularWorkflow = 1
            token outputs:surface
        }
    }
}
USD
cat >gold.py <<'PYTHON'
import base64
import json
import os
import struct

import bpy

corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
with open("gold.gltf", "w") as file:
    json.dump({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "extensionsUsed": ["KHR_materials_pbrSpecularGlossiness"],
        "materials": [{"name": "gold", "extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.8, 0.3], "glossinessFactor": 0.8}}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{
            "byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}]}, file)


def gold(read, path):
    """Base colour, metallic, index and specular tint of the material that a file has."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    read(filepath=os.path.abspath(path))
    inputs = bpy.data.materials["gold"].node_tree.nodes["Principled BSDF"].inputs
    return [tuple(round(x, 3) for x in inputs[name].default_value) if hasattr(inputs[name].default_value, "__len__")
            else inputs[name].default_value for name in ("Base Color", "Metallic", "IOR", "Specular Tint")]


usd, gltf = gold(bpy.ops.wm.usd_import, "gold.usda"), gold(bpy.ops.import_scene.gltf, "gold.gltf")
print("found: USD", usd, "glTF", gltf)
assert usd == [(0, 0, 0, 1), 0, 1.5, (1, 0.8, 0.3, 1)]
assert gltf == [(0, 0, 0, 1), 0, 1000, (1, 0.8, 0.3, 1)]
print("held")
PYTHON
venv/bin/python gold.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
