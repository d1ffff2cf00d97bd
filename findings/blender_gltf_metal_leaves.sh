#!/usr/bin/env bash
# bpy (glTF): a translucent leaf comes out as white metal, and KHR_materials_diffuse_transmission is lost.
#
# Expected: a leaf of glTF whose light shines through gets a Translucent BSDF, or a message. A leaf of Blender, Diffuse and
#           Translucent by Mix Shader as the manual has it, keeps at least its diffuse colour.
# Found:    the extension is dropped both ways without a word. Blender's own leaf is written as a material with a name alone:
#           glTF's defaults are white, metallic 1 and roughness 1. So green leaves are white metal elsewhere.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11. So does bpy 5.2.3.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >leaves.py <<'PYTHON'
import json
import os

import bpy

LEAF = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "extensionsUsed": ["KHR_materials_diffuse_transmission"],
    "materials": [{"name": "leaf", "pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.7, "diffuseTransmissionColorFactor": [1, 0.5, 0]}}}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
}
with open("leaf.gltf", "w") as file:
    json.dump(LEAF, file)


def written():
    bpy.ops.export_scene.gltf(filepath=os.path.abspath("out.gltf"), export_format="GLTF_SEPARATE")
    (material,) = json.load(open("out.gltf"))["materials"]
    return material


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=os.path.abspath("leaf.gltf"))
tree = bpy.data.materials["leaf"].node_tree
kinds = sorted(node.bl_idname for node in tree.nodes)
print("found: nodes of the leaf", kinds)
assert kinds == ["ShaderNodeBsdfPrincipled", "ShaderNodeOutputMaterial"]
print("found: on the way back", written())
assert "extensions" not in written()

# Blender's own leaf: green by Diffuse, a part of red by Translucent.
tree.nodes.clear()
add = lambda kind: tree.nodes.new("ShaderNode" + kind)
mix, green, red = add("MixShader"), add("BsdfDiffuse"), add("BsdfTranslucent")
mix.inputs[0].default_value = 0.7
green.inputs[0].default_value, red.inputs[0].default_value = (0, 1, 0, 1), (1, 0, 0, 1)
tree.links.new(green.outputs[0], mix.inputs[1])
tree.links.new(red.outputs[0], mix.inputs[2])
tree.links.new(mix.outputs[0], add("OutputMaterial").inputs[0])
own = written()
print("found: a Translucent leaf of Blender", own)
assert own == {"name": "leaf"}  # glTF: metallicFactor is 1 where it is not written
print("held")
PYTHON
venv/bin/python leaves.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
