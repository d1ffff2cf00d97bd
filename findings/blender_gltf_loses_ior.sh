#!/usr/bin/env bash
# bpy (glTF exporter): the index of refraction of a surface that is not glass is lost.
#
# Expected: a Principled BSDF's IOR is KHR_materials_ior whenever it is not 1.5: it says how much a dielectric mirrors, 0.8 %
#           for 1.2 and 17 % for 2.4.
# Found:    only with transmission, or with a specular level or tint that is not the default, is it written. So lacquer,
#           water and gems become 1.5, 4 %. A glTF file with an index of 1.2 loses it by import and export.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11. bpy 5.2.3 does the same.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >ior.py <<'PYTHON'
import base64
import json
import struct

import bpy


def written():
    """The index of the first material of the scene in a file, 1.5 where it has none."""
    bpy.ops.export_scene.gltf(filepath="out.gltf", export_format="GLTF_SEPARATE")
    with open("out.gltf") as file:
        return json.load(file)["materials"][0].get("extensions", {}).get("KHR_materials_ior", {}).get("ior", 1.5)


def exported(**inputs):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("triangle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("triangle", mesh))
    material = bpy.data.materials.new("surface")
    material.use_nodes = True
    for name, value in inputs.items():
        material.node_tree.nodes["Principled BSDF"].inputs[name.replace("_", " ")].default_value = value
    mesh.materials.append(material)
    return written()


def round_trip():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    with open("in.gltf", "w") as file:
        json.dump({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "materials": [{"extensions": {"KHR_materials_ior": {"ior": 1.2}}}], "extensionsUsed": ["KHR_materials_ior"],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                           "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,"
                         + base64.b64encode(corners).decode()}]}, file)
    bpy.ops.import_scene.gltf(filepath="in.gltf")
    return written()


found = {"1.2": exported(IOR=1.2), "2.4": exported(IOR=2.4), "read and written": round_trip()}
kept = {"glass": exported(IOR=2.4, Transmission_Weight=1.0), "specular": exported(IOR=2.4, Specular_IOR_Level=0.4)}
print("found:", found, "- kept:", kept)
assert all(value == 1.5 for value in found.values()) and all(abs(value - 2.4) < 1e-6 for value in kept.values())
PYTHON
venv/bin/python ior.py >log 2>&1 || { tail -20 log; exit 1; }
grep found: log
