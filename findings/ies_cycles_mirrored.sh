#!/usr/bin/env bash
# Cycles shows the lamp of an IES file as the mirror image of what Radiance shows, and starts it at another side.
#
# Expected: horizontal angles of a file go the same way round everywhere, so that a turn of the lamp makes two programs agree.
#           Candela become W/sr by one number, in one program at least.
# Found:    Radiance has C0 at +X and C90 at +Y. In Cycles C0 is at -Y and C90 at -X: clockwise, so that no turn of the lamp
#           makes an asymmetric profile right. 100 candela are 100 / 177.83 W/sr for a point of 1 W there, and 100 / 179
#           in Radiance; Blender's glTF exporter has 683.
# Tried:    bpy 5.0.1 and pyradiance 1.3.1 of PyPI (Radiance 6.0a), Python 3.11. bpy 5.2.3 does the same.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1 pyradiance==1.3.1
cat >lamp.ies <<'IES'
IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 5 1 2 0 0 0
1 1 10
0 45 90
0 90 180 270 360
100 100 0
100 200 0
100 50 0
100 25 0
100 100 0
IES
cat >in_radiance.py <<'PYTHON'
import json
import os
import subprocess

import pyradiance

home = os.path.dirname(pyradiance.__file__)
os.environ["PATH"] = os.path.join(home, "bin") + os.pathsep + os.environ["PATH"]
os.environ["RAYPATH"] = "." + os.pathsep + os.path.join(home, "lib")


def run(*command, data=b""):
    return subprocess.run(command, input=data, capture_output=True, check=True).stdout


run("ies2rad", "-o", "lamp", "lamp.ies")
with open("lamp.oct", "wb") as file:
    file.write(run("oconv", "lamp.rad"))
sides = {"+X": (10, 0), "+Y": (0, 10), "-X": (-10, 0), "-Y": (0, -10)}
points = "".join(f"{x} {y} -10 0 0 1\n" for x, y in sides.values())
rows = run("rtrace", "-h", "-I", "-ab", "0", "-dj", "0", "-ds", "0", "lamp.oct", data=points.encode()).decode().splitlines()
rows = [row for row in rows if row.strip()]
print(json.dumps({side: float(row.split()[0]) * 200 * 2**0.5 for side, row in zip(sides, rows)}))
PYTHON
cat >in_cycles.py <<'PYTHON'
import json
import math
import os

import bpy
import mathutils

sides = {"+X": (10, 0), "+Y": (0, 10), "-X": (-10, 0), "-Y": (0, -10)}
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 16, False
scene.render.resolution_x = scene.render.resolution_y = 8
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"


def add(name, data, place=(0, 0, 0), towards=None):
    made = bpy.data.objects.new(name, data)
    made.location, made.rotation_mode = place, "QUATERNION"
    if towards:
        made.rotation_quaternion = mathutils.Vector(towards).to_track_quat("-Z", "Y")
    scene.collection.objects.link(made)
    return made


floor = bpy.data.meshes.new("floor")
floor.from_pydata([(-20, -20, -10), (20, -20, -10), (20, 20, -10), (-20, 20, -10)], [], [(0, 1, 2, 3)])
matte = bpy.data.materials.new("matte")
matte.use_nodes = True
nodes = matte.node_tree
nodes.nodes.clear()
diffuse, output = nodes.nodes.new("ShaderNodeBsdfDiffuse"), nodes.nodes.new("ShaderNodeOutputMaterial")
diffuse.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1)
nodes.links.new(diffuse.outputs[0], output.inputs[0])
floor.materials.append(matte)
add("floor", floor)
lamp = bpy.data.lights.new("lamp", "POINT")
lamp.energy, lamp.shadow_soft_size, lamp.use_nodes = 1, 0, True
profile = lamp.node_tree.nodes.new("ShaderNodeTexIES")
profile.mode, profile.filepath = "EXTERNAL", os.path.abspath("lamp.ies")
lamp.node_tree.links.new(profile.outputs[0], lamp.node_tree.nodes["Emission"].inputs["Strength"])
add("lamp", lamp)
camera = bpy.data.cameras.new("camera")
camera.angle = math.radians(1)
eye = add("camera", camera)
scene.camera = eye
found = {}
for side, (x, y) in sides.items():
    eye.location = (x, y, -5)
    scene.render.filepath = os.path.abspath(f"{side}.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    reds = list(image.pixels)[0::4]
    found[side] = sum(reds) / len(reds) / (0.5 / math.pi) * 200 * 2**0.5
print(json.dumps(found))
PYTHON
venv/bin/python in_radiance.py | tee radiance.json
venv/bin/python in_cycles.py >log 2>&1 || { tail -20 log; exit 1; }
grep '^{' log >cycles.json
venv/bin/python - <<'PYTHON'
import json

radiance, cycles = json.load(open("radiance.json")), json.load(open("cycles.json"))
sent = {"C0": 100, "C90": 200, "C180": 50, "C270": 25}


def planes(intensity, lumens_per_watt):
    """Which plane of the file is seen at each side."""
    return {side: min(sent, key=lambda plane: abs(sent[plane] / lumens_per_watt / value - 1)) for side, value in intensity.items()}


print("found: Radiance", planes(radiance, 179), "- Cycles", planes(cycles, 177.83), "-", {k: v * 177.83 for k, v in cycles.items()})
assert planes(radiance, 179) == {"+X": "C0", "+Y": "C90", "-X": "C180", "-Y": "C270"}
assert planes(cycles, 177.83) == {"-Y": "C0", "-X": "C90", "+Y": "C180", "+X": "C270"}
assert abs(cycles["-X"] * 177.83 / 200 - 1) < 0.01 and abs(radiance["+Y"] * 179 / 200 - 1) < 0.01
PYTHON
