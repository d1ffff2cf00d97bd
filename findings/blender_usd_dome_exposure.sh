#!/usr/bin/env bash
# bpy (USD importer): the exposure of a DomeLight is ignored.
#
# Expected: UsdLux: a light's radiance is intensity times 2 to the exposure, so intensity 0.75 and exposure 3 give a
#           background of strength 6. The importer carries the exposure of a RectLight.
# Found:    strength 0.75: the dome is eight times too dark. The RectLight beside it has its exposure of 3.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >dome.usda <<'USD'
#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 1
)
def DomeLight "Dome" {
    float inputs:exposure = 3
    float inputs:intensity = 0.75
}
def RectLight "Panel" {
    float inputs:exposure = 3
    float inputs:intensity = 0.75
}
USD
cat >dome.py <<'PYTHON'
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.world = bpy.data.worlds.new("World")
bpy.ops.wm.usd_import(filepath=os.path.abspath("dome.usda"))
(background,) = (n for n in bpy.context.scene.world.node_tree.nodes if n.type == "BACKGROUND")
strength, (panel,) = background.inputs["Strength"].default_value, bpy.data.lights
print("found: strength of the dome", strength, "exposure of the panel", panel.exposure)
assert strength == 0.75 and panel.exposure == 3
print("held")
PYTHON
venv/bin/python dome.py | grep -E "found|held"
