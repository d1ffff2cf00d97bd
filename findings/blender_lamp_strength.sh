#!/usr/bin/env bash
# bpy (Cycles): a lamp that is not normalized gets brighter by a factor of 318,000 when its radius goes from 1 mm to 0.
#
# Expected: without "normalize" (Blender 4.5) the strength is times the lamp's area, so a lamp without a size gives
#           nothing, or is left as it is.
# Found:    points and spots are times 4 pi r^2, but times 4 at r = 0; suns are times pi sin^2(angle / 2), but times 1
#           at angle 0. A point of 1 mm gives 0.0000126 of a normalized one, a point of 0 gives 4 times of it.
# Tried:    bpy 4.5.15 of PyPI, Python 3.11, Cycles on the CPU.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.15
cat >lamps.py <<'PYTHON'
import math
import os

import bpy


def seen(kind, **settings):
    """What a white diffuse square shows, two metres below a lamp."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=0.02)
    material = bpy.data.materials.new("white")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    bpy.context.object.data.materials.append(material)
    light = bpy.data.lights.new("lamp", kind)
    for name, value in settings.items():
        setattr(light, name, value)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 0.01
    for data, height in ((light, 2), (camera, 1)):  # the camera is the last
        thing = bpy.data.objects.new(data.name, data)
        thing.location = (0, 0, height)
        scene.collection.objects.link(thing)
    scene.camera = thing
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 64
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = os.path.abspath("seen.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    return sum(image.pixels[:][0::4]) / 16


def factor(kind, **settings):
    return seen(kind, normalize=False, **settings) / seen(kind, normalize=True, **settings)


for kind in ("POINT", "SPOT"):
    for radius in (0.1, 0.001, 0.0):
        found = factor(kind, energy=100, shadow_soft_size=radius)
        expected = 4 * math.pi * radius**2 if radius else 4.0
        print(f"lamp: {kind} of radius {radius}: {found:.6g}")
        assert abs(found / expected - 1) < 0.01
for angle in (0.1, 0.0):
    found = factor("SUN", energy=3, angle=angle)
    print(f"lamp: SUN of angle {angle}: {found:.6g}")
    assert abs(found / (math.pi * math.sin(angle / 2) ** 2 if angle else 1.0) - 1) < 0.01
print("lamp: all as found before")
PYTHON
venv/bin/python lamps.py | grep "^lamp: "
