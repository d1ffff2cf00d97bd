"""How long a change of the world takes to reach the colours of an object, in Blender:

blender -b --factory-startup --python-use-system-env --python measure.py -- MESH.ply ENVIRONMENT

with the Python package on PYTHONPATH."""

import os
import sys
import tempfile
import time

import bpy
import numpy as np

import relumine

mesh, environment = map(os.path.abspath, sys.argv[sys.argv.index("--") + 1 :])
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import addon

addon.load()
from relumine_lights import assets, worlds

for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
bpy.ops.import_mesh.ply(filepath=mesh)
thing = bpy.context.object
thing.select_set(True)
scene = bpy.context.scene
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
tree = scene.world.node_tree
background = next(node for node in tree.nodes if node.type == "BACKGROUND")
texture = tree.nodes.new("ShaderNodeTexEnvironment")
texture.image = bpy.data.images.load(environment)
mapping = tree.nodes.new("ShaderNodeMapping")
coordinates = tree.nodes.new("ShaderNodeTexCoord")
tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
tree.links.new(texture.outputs["Color"], background.inputs["Color"])
folder = tempfile.TemporaryDirectory()
path = os.path.join(folder.name, "scene.prt")
bpy.ops.relumine.precompute(filepath=path)
made = relumine.Scene.load(path)

# What the parts take: the add-on calls these.
parts = {}


def timed(holder, name, label):
    function = getattr(holder, name)

    def wrapper(*arguments, **options):
        start = time.perf_counter()
        try:
            return function(*arguments, **options)
        finally:
            parts[label] = parts.get(label, 0.0) + time.perf_counter() - start

    setattr(holder, name, wrapper)


timed(worlds.WorldLight, "environment", "turning the world")
timed(assets, "write_colors", "writing the attribute")
timed(relumine.Relighter, "set_environment", "relighting")


def colors():
    data = thing.data.color_attributes["Relumine"].data
    values = np.empty(4 * len(data), dtype=np.float32)
    data.foreach_get("color", values)
    return values


rounds = []
for turn in range(24):
    before = colors()
    parts.clear()
    start = time.perf_counter()
    mapping.inputs["Rotation"].default_value[turn % 3] += np.radians(7.0)
    bpy.context.view_layer.update()
    seconds = time.perf_counter() - start
    assert (colors() != before).any(), scene.relumine.error or "no change"
    rounds.append((seconds, dict(parts)))
rounds.sort(key=lambda each: each[0])
seconds, parts_of_median = rounds[len(rounds) // 2]
print(f"{len(thing.data.vertices)} vertices, {made}")
print(f"a turn of the world about one axis after the other: least {1e3 * rounds[0][0]:.1f} ms, "
      f"median {1e3 * seconds:.1f} ms")  # fmt: skip
for label, part in parts_of_median.items():
    print(f"  {label}: {1e3 * part:.1f} ms")
