#!/usr/bin/env bash
# bpy (USD importer): a lamp of a stage in centimetres is 10,000 times too bright, or as large as the room.
#
# Expected: metersPerUnit 0.01, which is also USD's default, makes the scene 100 times smaller and leaves its light as it is:
#           a panel keeps its radiance, and what lies 300 units below it keeps its irradiance.
# Found:    places and sizes of objects are scaled, lights are not. A RectLight with `normalize` keeps its watts on an area
#           that is 10,000 times smaller. A SphereLight keeps its radius in metres: a bulb of 5 cm becomes a ball of 5 m.
#           A RectLight without `normalize` is right.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11, Cycles on the CPU.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >lamps.py <<'PYTHON'
import math
import os

import bpy
import numpy as np

ALBEDO = 0.5


def imported(kind, unit, normalize):
    """A stage with one light at height 400, and what is 400 below it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with open("lamp.usda", "w") as file:
        file.write(f"""#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = {unit}
)
def {kind} "lamp"
{{
    float inputs:intensity = 10
    bool inputs:normalize = {int(normalize)}
    float inputs:radius = 5
    float inputs:width = 100
    float inputs:height = 100
    double3 xformOp:translate = (0, 0, 400)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
""")
    bpy.ops.wm.usd_import(filepath=os.path.abspath("lamp.usda"))
    (light,) = bpy.data.lights
    return light


def irradiance(unit):
    """What the floor below the light gets, from a picture of it."""
    bpy.ops.mesh.primitive_plane_add(size=2000 * unit)
    matte = bpy.data.materials.new("matte")
    matte.use_nodes = True
    tree = matte.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
    tree.links.new(diffuse.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])
    bpy.context.object.data.materials.append(matte)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.data.angle, camera.data.clip_start = (0, 0, 300 * unit), 0.02, 1e-4
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 64, False
    scene.cycles.max_bounces = 0
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", os.path.abspath("out.exr")
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(scene.render.filepath).pixels).reshape(-1, 4)
    return float(pixels[:, :3].mean()) / ALBEDO * math.pi


found = {(unit, normalize): (imported("RectLight", unit, normalize), irradiance(unit))[1]
         for unit in (1, 0.01) for normalize in (False, True)}
for (unit, normalize), value in found.items():
    print("found: panel,", "normalized," if normalize else "plain,", "unit", unit, "- irradiance", value)
radius = {unit: imported("SphereLight", unit, False).shadow_soft_size for unit in (1, 0.01)}
print("found: radius of 5 units", radius, "m")
assert abs(found[1, False] / (10 * 100**2 / 400**2) - 1) < 0.05 and abs(found[0.01, False] / found[1, False] - 1) < 0.02
assert abs(found[0.01, True] / found[1, True] / 1e4 - 1) < 0.05
assert radius == {1: 5, 0.01: 5}
print("held")
PYTHON
venv/bin/python lamps.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
