#!/usr/bin/env bash
# bpy (USD importer): a CylinderLight becomes a point.
#
# Expected: a light of the cylinder's size, or none and a line that says so.
# Found:    a point light of radius 0, whatever radius and length the cylinder has, and nothing is said. Its shadows are
#           sharp, and a cylinder ten times as long gives the same light.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >tubes.usda <<'USD'
#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 1
)
def CylinderLight "Short" {
    float inputs:intensity = 10
    float inputs:length = 1
    float inputs:radius = 0.25
}
def CylinderLight "Long" {
    float inputs:intensity = 10
    float inputs:length = 10
    float inputs:radius = 0.25
}
USD
cat >tubes.py <<'PYTHON'
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=os.path.abspath("tubes.usda"))
found = {o.name: (o.data.type, o.data.energy, o.data.shadow_soft_size) for o in bpy.data.objects}
print("found:", found)
assert found["Short"] == found["Long"]
assert found["Long"][0] == "POINT" and found["Long"][2] == 0 and found["Long"][1] > 0
print("held")
PYTHON
venv/bin/python tubes.py | grep -E "found|held"
