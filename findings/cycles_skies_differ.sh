#!/usr/bin/env bash
# bpy (Cycles): the same clear sky is 50 times brighter in one model than in the other, and its sun turns the wrong way.
#
# Expected: the types of the sky texture are models of one sky. Without the sun's disc they light a floor within a factor of two,
#           so that a scene survives a change of the type. sun_rotation turns about +Z as everything in Blender does: from +Y
#           by 90 degrees to -X.
# Found:    with the sun 53 degrees high the sky gives the floor 14 (multiple scattering), 9 (single scattering), 1.9 (Preetham)
#           and 0.26 (Hosek and Wilkie); the last two have no sun. A sun_rotation of 90 degrees puts the sun at +X, clockwise
#           from above. Mapping nodes and lamps turn the other way.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11, Cycles on the CPU.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >skies.py <<'PYTHON'
import math
import os

import bpy
import numpy as np
from mathutils import Vector

ALBEDO = 0.5


def irradiance(kind, normal=(0, 0, 1), disc=False, rotation=0):
    """What a matte plane gets from a sky, from a picture of it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, world = bpy.context.scene, bpy.data.worlds.new("world")
    scene.world, world.use_nodes = world, True
    sky = world.node_tree.nodes.new("ShaderNodeTexSky")
    world.node_tree.links.new(sky.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
    sky.sky_type = kind
    if kind in ("PREETHAM", "HOSEK_WILKIE"):
        sky.sun_direction, sky.turbidity = (0, 0.6, 0.8), 3
    else:
        sky.sun_disc, sky.sun_elevation, sky.sun_rotation = disc, math.asin(0.8), rotation
    turn = Vector(normal).to_track_quat("Z", "Y").to_euler()
    bpy.ops.mesh.primitive_plane_add(size=2, rotation=turn)
    matte = bpy.data.materials.new("matte")
    matte.use_nodes = True
    diffuse = matte.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
    matte.node_tree.links.new(diffuse.outputs["BSDF"], matte.node_tree.nodes["Material Output"].inputs["Surface"])
    bpy.context.object.data.materials.append(matte)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler, camera.data.angle = Vector(normal) * 5, turn, 0.02
    scene.collection.objects.link(camera)
    scene.camera = camera
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 128
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 128, False
    scene.cycles.max_bounces = 0
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", os.path.abspath("out.exr")
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(scene.render.filepath).pixels).reshape(-1, 4)
    return float(pixels[:, 1].mean()) / ALBEDO * math.pi


kinds = {"MULTIPLE_SCATTERING": 14.2, "SINGLE_SCATTERING": 9.16, "PREETHAM": 1.86, "HOSEK_WILKIE": 0.258}
sky = {kind: irradiance(kind) for kind in kinds}
sun = {name: irradiance("SINGLE_SCATTERING", normal, True, math.pi / 2) for name, normal in (("+X", (1, 0, 0)), ("-X", (-1, 0, 0)))}
print("found: floor below the sky alone", sky)
print("found: walls towards a sun turned by 90 degrees", sun)
assert all(abs(sky[kind] / expected - 1) < 0.08 for kind, expected in kinds.items())
assert sun["+X"] > 5 * sun["-X"]
print("held")
PYTHON
venv/bin/python skies.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
