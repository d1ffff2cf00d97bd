#!/usr/bin/env bash
# bpy (Cycles): an IES file of 2019 is up to 11 % too bright: how the file was made counts as a factor.
#
# Expected: the number behind the ballast factor is a factor in files of 1986 and 1991 alone. LM-63-95 and LM-63-02 keep it
#           for the future, as 1. In LM-63-19 it is the file generation type: 1.10000 is a simulation.
# Found:    candela are multiplied by it: 1.1 times as bright.
# Tried:    bpy 4.5.15 of PyPI, Python 3.11, Cycles on the CPU. three.js' IESLoader multiplies as well, but divides by the
#           largest, so nothing is seen there.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.15
cat >lamps.py <<'PYTHON'
import os

import bpy
from mathutils import Vector


def profile(horizontal, candela, head="IESNA:LM-63-2002", third="1"):
    vertical = range(0, 181, 15)
    lines = [head, "TILT=NONE", f"1 -1 1 {len(vertical)} {len(horizontal)} 1 2 0 0 0", f"1 {third} 1"]
    lines += [" ".join(map(str, vertical)), " ".join(map(str, horizontal))]
    return "\n".join(lines + [" ".join(str(candela(h)) for _ in vertical) for h in horizontal]) + "\n"


def seen(direction, text):
    """What a white card shows, a metre from a point with a profile, and facing it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    way = Vector(direction).normalized()
    bpy.ops.mesh.primitive_plane_add(size=0.02, location=way)
    card = bpy.context.object
    card.rotation_euler = (-way).to_track_quat("Z", "Y").to_euler()
    material = bpy.data.materials.new("white")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    card.data.materials.append(material)
    light = bpy.data.lights.new("lamp", "POINT")
    light.energy, light.shadow_soft_size, light.use_nodes = 1, 0, True
    nodes = light.node_tree.nodes
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputLight")
    ies = nodes.new("ShaderNodeTexIES")
    block = bpy.data.texts.new("ies")
    block.write(text)
    ies.mode, ies.ies = "INTERNAL", block
    light.node_tree.links.new(ies.outputs[0], emission.inputs["Strength"])
    light.node_tree.links.new(emission.outputs[0], output.inputs[0])
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 0.01
    for data, place in ((light, (0, 0, 0)), (camera, way / 2)):  # the camera is the last
        thing = bpy.data.objects.new(data.name, data)
        thing.location = place
        scene.collection.objects.link(thing)
    thing.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    scene.camera = thing
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = os.path.abspath("seen.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    return sum(image.pixels[:][0::4]) / 16


steps = range(0, 361, 15)
plain = seen((0, 0, -1), profile(steps, lambda h: 1000))
found = seen((0, 0, -1), profile(steps, lambda h: 1000, "IES:LM-63-2019", "1.10000")) / plain
print(f"lamp: file generation type 1.10000: {found:.4f} times as bright")
assert abs(found - 1.1) < 0.001
print("lamp: all as found before")
PYTHON
venv/bin/python lamps.py | grep "^lamp: "
