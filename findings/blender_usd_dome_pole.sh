#!/usr/bin/env bash
# bpy (USD importer): a DomeLight_1 whose pole is Z, as it is by default in a stage with Z up, stands wrong.
#
# Expected: the pole axis is a turn of 90 degrees about X before the light's own (OpenUSD, domeLight_1Adapter.cpp). So such
#           a light stands as a DomeLight with `rotateX = 90` does, whatever the stage's up axis is.
# Found:    the two are 120 degrees apart in a stage with Z up, and 180 in one with Y up. In Cycles it is the DomeLight
#           whose light arrives from where the picture has it.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >pole.py <<'PYTHON'
import math
import os

import bpy

SKY = " asset inputs:texture:file = @./sky.exr@\n"
LIGHTS = {
    "pole": 'def DomeLight_1 "L" {\n' + SKY + ' uniform token poleAxis = "Z"\n}\n',
    "turn": 'def DomeLight "L" {\n' + SKY + ' float xformOp:rotateX = 90\n'
            ' uniform token[] xformOpOrder = ["xformOp:rotateX"]\n}\n',
}


def turned(up, light):
    """The turn of the world's picture."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("World")
    with open("dome.usda", "w") as file:
        file.write(f'#usda 1.0\n(\n upAxis = "{up}"\n metersPerUnit = 1\n)\n{LIGHTS[light]}')
    bpy.ops.wm.usd_import(filepath=os.path.abspath("dome.usda"))
    (mapping,) = (n for n in bpy.context.scene.world.node_tree.nodes if n.type == "MAPPING")
    return mapping.inputs["Rotation"].default_value.to_quaternion()


sky = bpy.data.images.new("sky", 4, 2, float_buffer=True)
sky.file_format = "OPEN_EXR"
sky.filepath_raw = os.path.abspath("sky.exr")
sky.save()
found = {}
for up in "ZY":
    turn = turned(up, "pole").rotation_difference(turned(up, "turn"))
    found[up] = round(math.degrees(min(turn.angle, 2 * math.pi - turn.angle)))
print("found: degrees between the two", found)
assert found == {"Z": 120, "Y": 180}
print("held")
PYTHON
venv/bin/python pole.py | grep -E "found|held"
