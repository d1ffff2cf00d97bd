#!/usr/bin/env bash
# bpy (USD importer): a DistantLight becomes a sun four times as strong and twice as wide.
#
# Expected: UsdLux: with `normalize` an intensity of 3 is an irradiance of 3, and `angle` is the angle across. Blender's
#           sun has its irradiance as strength and its angle across too, so both numbers stay.
# Found:    strength 12 and twice the angle, with `normalize` and without. Without it the light grows with the disc's
#           area as well, so a sun is 16 times as bright.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >sun.usda <<'USD'
#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 1
)
def DistantLight "Sun" {
    float inputs:angle = 10
    float inputs:intensity = 3
    bool inputs:normalize = 1
}
USD
cat >sun.py <<'PYTHON'
import math
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=os.path.abspath("sun.usda"))
(sun,) = bpy.data.lights
print("found:", sun.type, "strength", sun.energy, "degrees", round(math.degrees(sun.angle), 3))
assert sun.type == "SUN"
assert math.isclose(sun.energy, 12, rel_tol=1e-4)
assert math.isclose(math.degrees(sun.angle), 20, rel_tol=1e-4)
print("held")
PYTHON
venv/bin/python sun.py | grep -E "found|held"
