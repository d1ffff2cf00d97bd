#!/usr/bin/env bash
# bpy (USD exporter): a lamp's colour temperature that is switched off counts in the file.
#
# Expected: `inputs:enableColorTemperature` is what Blender's lamp has as `use_temperature`, which is off by default.
# Found:    it is written as 1 for every lamp. One whose temperature was 2,000 K once and is white again, is orange in the
#           file, with a twelfth of the blue. Lamps that nobody touched have 6,500 K, which is 1.043, 0.984, 1.035 in
#           UsdLux and not white. Blender reads its own file with the temperature on.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >lamp.py <<'PYTHON'
import os

import bpy

bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdLux

bpy.ops.wm.read_factory_settings(use_empty=True)
for name, temperature in (("touched", 2000), ("new", None)):
    lamp = bpy.data.lights.new(name, "POINT")
    if temperature:
        lamp.temperature = temperature
    print("found: before:", name, "use_temperature", lamp.use_temperature, lamp.temperature)
    assert not lamp.use_temperature
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, lamp))
bpy.ops.wm.usd_export(filepath=os.path.abspath("lamp.usda"))
stage, tint = Usd.Stage.Open("lamp.usda"), {}
for prim in stage.Traverse():
    if prim.IsA(UsdLux.SphereLight):
        light = UsdLux.LightAPI(prim)
        assert light.GetEnableColorTemperatureAttr().Get()
        tint[prim.GetName()] = tuple(UsdLux.BlackbodyTemperatureAsRgb(light.GetColorTemperatureAttr().Get()))
print("found: colours in the file", tint)
assert tint["touched"][2] < tint["touched"][0] / 12 and max(abs(x - y) for x, y in zip(tint["new"], (1.043, 0.984, 1.035))) < 0.002
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=os.path.abspath("lamp.usda"))
after = {lamp.name: (lamp.use_temperature, lamp.temperature) for lamp in bpy.data.lights}
print("found: after import", after)
assert after == {"touched": (True, 2000), "new": (True, 6500)}
print("held")
PYTHON
venv/bin/python lamp.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
