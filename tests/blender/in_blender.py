"""Runs in `blender -b`: the add-on against the command line. PROGRAM FOLDER follow `--`."""

import os
import subprocess
import sys
import traceback

import bpy
import numpy as np
from mathutils import Vector

import relumine

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import addon

relumine_lights = addon.load()
from relumine_lights import assets

program, folder = sys.argv[sys.argv.index("--") + 1 :]
os.chdir(folder)


def colors(thing):
    data = thing.data.color_attributes["Relumine"].data
    values = np.empty(4 * len(data), dtype=np.float32)
    data.foreach_get("color", values)
    return values.reshape(-1, 4)[:, :3]


def command_line(*arguments):
    """The numbers of `relumine relight`."""
    subprocess.run(
        [program, "relight", "scene.prt", *arguments, "--albedo", "1", "-o", "out.npy"],
        check=True, capture_output=True,
    )  # fmt: skip
    return np.load("out.npy")


def close(a, b, what):
    error = np.linalg.norm(a - b) / np.linalg.norm(b)
    assert error < 1e-5, f"{what}: {error}"
    print(f"{what}: {error:.1e}")


def of_world(rotate):
    return command_line(
        "sky.exr", "--from", "blender", "--rotate", str(rotate), "--face-resolution", "32"
    )


def in_file(thing, values):
    return values[thing["relumine_first"] :][: thing["relumine_count"]]


def test():
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene.relumine.face_resolution, scene.relumine.tolerance = 32, 0.05

    # A turned and scaled head over a ground that is subdivided by a modifier, and an icosphere
    # that a modifier mirrors.
    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1.2), rotation=(0.2, 0.1, 0.7))
    head = bpy.context.object
    head.scale = (1.0, 1.3, 0.8)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=8)
    ground = bpy.context.object
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(2, 0, 1))
    ball = bpy.context.object
    mirror = ball.modifiers.new("mirror", "MIRROR")
    mirror.mirror_object = head
    wave = ground.modifiers.new("wave", "DISPLACE")
    wave.strength = 0.2
    for thing in (head, ground, ball):
        thing.select_set(True)

    # The world: an image, turned by a mapping.
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(os.path.abspath("sky.exr"))
    mapping = tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])

    result = bpy.ops.relumine.precompute(filepath=os.path.abspath("scene.prt"))
    assert result == {"FINISHED"}
    assert head["relumine_prt"] == os.path.abspath("scene.prt")
    assert relumine.Scene.load("scene.prt").num_receivers == sum(
        thing["relumine_count"] for thing in (head, ground, ball)
    )
    still = of_world(0)
    close(colors(head), in_file(head, still), "first light, head")
    close(colors(ground), in_file(ground, still), "first light, ground")
    assert len(ball.data.vertices) * 2 == ball["relumine_count"]
    assert len(colors(ball)) == len(ball.data.vertices)
    close(colors(ball), in_file(ball, still)[: len(ball.data.vertices)], "first light, mirrored")

    # Where light comes from: the picture's brightest direction, by Blender's own rule, lights more.
    heights = np.array([head.matrix_world @ v.co for v in head.data.vertices])
    normals = np.array([head.matrix_world.to_3x3().inverted().transposed() @ v.normal
                        for v in head.data.vertices])  # fmt: skip
    lamp = np.array([1.0, -1.0, 1.0]) / np.sqrt(3)  # conftest's lamp, seen by Blender
    facing = normals @ lamp / np.linalg.norm(normals, axis=1)
    assert colors(head)[facing > 0.8].mean() > 2 * colors(head)[facing < -0.5].mean()
    assert len(heights) == len(facing)

    # The world changes: the handler follows.
    mapping.inputs["Rotation"].default_value[2] = np.radians(40)
    bpy.context.view_layer.update()
    close(colors(head), in_file(head, of_world(-40)), "mapping as a point")
    mapping.inputs["Rotation"].default_value = (np.radians(70), 0.0, 0.0)
    bpy.context.view_layer.update()
    tilted = command_line(
        "sky.exr", "--from", "blender", "--tilt", "-70", "--face-resolution", "32"
    )
    close(colors(head), in_file(head, tilted), "turned about X")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, np.radians(40))
    mapping.vector_type = "TEXTURE"
    bpy.context.view_layer.update()
    close(colors(head), in_file(head, of_world(40)), "mapping as a texture")
    background.inputs["Strength"].default_value = 2.5
    bpy.context.view_layer.update()
    close(colors(head), 2.5 * in_file(head, of_world(40)), "strength")

    # A sun on top.
    data = bpy.data.lights.new("sun", "SUN")
    data.energy, data.color = 3.0, (1.0, 0.5, 0.25)
    sun = bpy.data.objects.new("sun", data)
    sun.rotation_euler, data.angle = (0.6, 0.0, 0.5), 0.0
    scene.collection.objects.link(sun)
    bpy.context.view_layer.update()
    towards = sun.matrix_world.to_3x3() @ Vector((0, 0, 1))
    relumine.LightList(
        [[towards.x, towards.z, -towards.y]], [[3.0, 1.5, 0.75]]
    ).save("sun.json")
    under_sun = command_line("--lights", "sun.json")
    both = 2.5 * of_world(40) + under_sun
    close(colors(head), in_file(head, both), "sun and world")
    sun.rotation_euler[0] = 0.9
    bpy.context.view_layer.update()
    assert np.linalg.norm(colors(head) - in_file(head, both)) > 0.01
    bpy.data.objects.remove(sun)
    bpy.context.view_layer.update()
    close(colors(head), 2.5 * in_file(head, of_world(40)), "without the sun")

    # Undo brings back older data; the handler writes the present.
    before = colors(head)
    head.data.color_attributes["Relumine"].data.foreach_set(
        "color", np.zeros(4 * len(before), dtype=np.float32)
    )
    relumine_lights.on_undo(scene)
    assert (colors(head) == before).all()
    head.data.color_attributes.remove(head.data.color_attributes["Relumine"])
    relumine_lights.on_undo(scene)
    assert (colors(head) == before).all()

    # A saved file knows its scene file.
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath("saved.blend"))
    scene, head = bpy.context.scene, bpy.data.objects["Suzanne"]
    assert head["relumine_prt"] == os.path.abspath("scene.prt")
    close(colors(head), before, "opened again")

    # Lights in place of the world: their power is the world's, and they do not light twice.
    assert bpy.ops.relumine.pull_lights(number=64) == {"FINISHED"}
    suns = bpy.data.collections["Relumine lights"].objects
    assert len(suns) == 64
    power = sum(np.array(s.data.color) * s.data.energy for s in suns)
    whole = relumine.Environment.load("sky.exr").median_cut(64).total_irradiance
    assert np.allclose(power, 2.5 * whole, rtol=5e-3), (power, whole)
    bpy.context.view_layer.update()
    close(colors(head), before, "with pulled lights")
    up = [(s.matrix_world.to_3x3() @ Vector((0, 0, 1))).z for s in suns]
    assert max(up) > 0.5 > -0.5 > min(up)

    # Blender's own undo.
    bpy.ops.ed.undo_push(message="before")
    strength = scene.world.node_tree.nodes["Background"].inputs["Strength"]
    strength.default_value = 5.0
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="after")
    close(colors(head), 2 * before, "brighter")
    bpy.ops.ed.undo()
    scene, head = bpy.context.scene, bpy.data.objects["Suzanne"]
    assert head["relumine_prt"] == os.path.abspath("scene.prt")
    close(colors(head), before, "undone")

    # Errors are told, not raised.
    os.rename("scene.prt", "elsewhere.prt")
    strength = scene.world.node_tree.nodes["Background"].inputs["Strength"]
    strength.default_value = 3.0
    bpy.context.view_layer.update()
    assert "scene.prt: cannot read" in scene.relumine.error
    os.rename("elsewhere.prt", "scene.prt")
    strength.default_value = 2.5
    bpy.context.view_layer.update()
    assert scene.relumine.error == ""
    relumine_lights.unregister()


try:
    test()
    print("all is well")
except Exception:
    traceback.print_exc()
    sys.stdout.flush()
    os._exit(1)
