#!/usr/bin/env bash
# bpy (USD exporter): glass and water become opaque, painted with their tint.
#
# Expected: UsdPreviewSurface has no transmission, so a Principled BSDF with Transmission Weight 1 gets an opacity of 0, which
#           with opacityMode "transparent" is glass there, or a warning. The index is written.
# Found:    opacity 1, and the tint as diffuseColor: what was behind is hidden, and light does not come through. Nothing is
#           said. A weight of 1 comes back as 0. Alpha is what counts as opacity.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >glass.py <<'PYTHON'
import os

import bpy

bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdShade

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add()
glass = bpy.data.materials.new("glass")
glass.use_nodes = True
inputs = glass.node_tree.nodes["Principled BSDF"].inputs
inputs["Base Color"].default_value = (0.2, 0.5, 0.8, 1)
inputs["Transmission Weight"].default_value, inputs["IOR"].default_value = 1, 1.33
bpy.context.object.data.materials.append(glass)
bpy.ops.wm.usd_export(filepath=os.path.abspath("glass.usda"))
stage = Usd.Stage.Open("glass.usda")
(shader,) = (UsdShade.Shader(prim) for prim in stage.Traverse() if prim.IsA(UsdShade.Shader))
written = {x.GetBaseName(): x.Get() for x in shader.GetInputs()}
print("found:", {name: written[name] for name in ("diffuseColor", "ior", "opacity")}, "opacityMode" in written)
assert written["opacity"] == 1 and "opacityMode" not in written and "opacityThreshold" not in written
assert all(abs(x - y) < 1e-6 for x, y in zip(written["diffuseColor"], (0.2, 0.5, 0.8)))
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=os.path.abspath("glass.usda"))
weight = bpy.data.materials["glass"].node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value
print("found: Transmission Weight after import", weight)
assert weight == 0
print("held")
PYTHON
venv/bin/python glass.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
