#!/usr/bin/env bash
# bpy (glTF exporter): lights are multiplied by 683 lumens per watt, emission is not.
#
# Expected: a lamp and a glowing surface that light alike in Cycles do so from the exported file as well; both have
#           photometric units in glTF (candela, candela per square metre).
# Found:    in the default mode ("Standard") a point or spot of P watts has P / (4 pi) * 683 candela and a sun of E has
#           E * 683 lux, but a surface of strength 30 has an emissiveStrength of 30. So lamps are 683 times too bright
#           beside panels. The mode "Unitless" leaves 683 out, and nothing in the file says which mode it was.
# Tried:    bpy 4.5.15 of PyPI (exporter 4.5.51), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.15
cat >lights.py <<'PYTHON'
import json
import math
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
for kind in ("POINT", "SPOT", "SUN"):
    light = bpy.data.lights.new(kind, kind)
    light.energy = 100
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(kind, light))
bpy.ops.mesh.primitive_plane_add(size=1)
panel = bpy.data.materials.new("panel")
panel.use_nodes = True
shader = panel.node_tree.nodes["Principled BSDF"]
shader.inputs["Emission Color"].default_value = (1, 1, 1, 1)
shader.inputs["Emission Strength"].default_value = 30
bpy.context.object.data.materials.append(panel)


def exported(mode):
    """Intensities of the lights, the strength of the panel, and what the file says of its maker."""
    path = os.path.abspath("lights.gltf")
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE", export_lights=True,
                              export_import_convert_lighting_mode=mode)
    with open(path) as file:
        document = json.load(file)
    lights = [light["intensity"] for light in document["extensions"]["KHR_lights_punctual"]["lights"]]
    strength = document["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
    return lights, strength, document["asset"]


for mode, factor in (("SPEC", 683), ("COMPAT", 1)):
    lights, strength, asset = exported(mode)
    print("found:", mode, lights, strength, asset)
    for intensity, expected in zip(lights, (100 / (4 * math.pi), 100 / (4 * math.pi), 100)):
        assert math.isclose(intensity, expected * factor, rel_tol=1e-4)
    assert strength == 30
    assert set(asset) == {"generator", "version"}
print("held")
PYTHON
venv/bin/python lights.py | grep -E "found|held"
