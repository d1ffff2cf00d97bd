"""Runs in a Blender of its own: renders worlds as panoramas, one for each line of its input.

A line is JSON: the .blend that holds the world, its name, the frame, the width, what stays out of
the picture because it is applied later (a mapping's turn, the strength), and the .npy to write.
"""

import json
import os
import sys
import tempfile

import bpy
import numpy as np

#: Marks a line of output as an answer; Blender prints others.
ANSWER = "RELUMINE "
#: What nodes of light paths say to a ray that a matt surface sends out.
DIFFUSE_RAY = {
    "Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Length": 1e10, "Ray Depth": 1.0,
    "Diffuse Depth": 1.0,
}  # fmt: skip
SAMPLES = 16
#: Squares of the panorama whose single pixels hold much of the light are rendered again.
SQUARE, SQUARES, MUCH, SAMPLES_OF_SQUARE = 16, 24, 2e-3, 4096


def all_trees(tree, seen=None):
    """A node tree and those of its groups."""
    seen = {} if seen is None else seen
    if tree is not None and tree.name not in seen:
        seen[tree.name] = tree
        for node in tree.nodes:
            if node.type == "GROUP":
                all_trees(node.node_tree, seen)
    return list(seen.values())


def see_as_matt_surfaces(tree):
    """The camera's rays get the light that matt surfaces get."""
    for node in [node for node in tree.nodes if node.type == "LIGHT_PATH"]:
        for output in node.outputs:
            targets = [link.to_socket for link in output.links]
            if targets:
                value = tree.nodes.new("ShaderNodeValue")
                value.outputs[0].default_value = DIFFUSE_RAY.get(output.name, 0.0)
                for target in targets:
                    tree.links.new(value.outputs[0], target)


def prepare(job):
    """Makes the world of a job the scene's."""
    with bpy.data.libraries.load(job["blend"]) as (_, wanted):
        wanted.worlds = [job["world"]]
    world = wanted.worlds[0]
    for name, path in job["pixels"].items():  # images that were painted and not saved
        bpy.data.images[name].pixels.foreach_set(np.load(path))
    scene = bpy.context.scene
    scene.world = world
    world.cycles.sampling_method = "NONE"
    visibility = world.cycles_visibility
    visibility.camera = visibility.diffuse
    for tree in all_trees(world.node_tree):
        see_as_matt_surfaces(tree)
    nodes = world.node_tree.nodes
    if job["turned_by"]:
        still(world, nodes[job["turned_by"]].inputs["Rotation"], (0.0, 0.0, 0.0))
    if job["strength_of"]:
        still(world, nodes[job["strength_of"]].inputs["Strength"], 1.0)
    scene.frame_set(job["frame"])
    return scene


def curves_of(animation):
    """The collections of curves that animate a thing."""
    action = animation.action
    if action is None:
        return []
    if hasattr(action, "fcurves"):
        return [action.fcurves]
    # Blender 5 knows curves by layer, strip and slot alone.
    bags = [strip.channelbag(animation.action_slot) for layer in action.layers for strip in layer.strips]
    return [bag.fcurves for bag in bags if bag is not None]


def still(world, socket, value):
    """Sets a socket that may be animated."""
    animation = world.node_tree.animation_data
    path = socket.path_from_id("default_value")
    if animation is not None:
        for driver in [each for each in animation.drivers if each.data_path == path]:
            animation.drivers.remove(driver)
        for curves in curves_of(animation):
            for curve in [each for each in curves if each.data_path == path]:
                curves.remove(curve)
    socket.default_value = value


def look_around(scene, width):
    """A camera whose picture has Blender's own layout of environment textures."""
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    data = bpy.data.cameras.new("camera")
    data.type = "PANO"
    # Blender 5 moved it from Cycles to the camera.
    holder = data if hasattr(data, "panorama_type") else data.cycles
    holder.panorama_type = "EQUIRECTANGULAR"
    camera = bpy.data.objects.new("camera", data)
    camera.rotation_euler = (np.pi / 2, 0.0, -np.pi / 2)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
    render.film_transparent = False
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    cycles.device = "CPU"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.film_exposure = 1.0


def rendered(scene, samples):
    """(height, width, 3), the top row first."""
    scene.cycles.samples = samples
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "world.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        width, height = image.size
        pixels = np.empty(width * height * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1, :, :3].copy()


def bright_squares(pixels):
    """(row, column) of squares with pixels that hold much of the light, the most first."""
    height = len(pixels)
    solid_angle = np.sin(np.pi * (np.arange(height) + 0.5) / height)[:, None]
    light = np.nan_to_num(pixels.max(axis=2)) * solid_angle
    share = light / max(float(light.sum()), 1e-30)
    shape = (height // SQUARE, SQUARE, pixels.shape[1] // SQUARE, SQUARE)
    brightest = share.reshape(shape).max(axis=(1, 3))
    # A light on a square's edge reaches into the next square.
    wide = np.pad(share, ((1, 1), (0, 0)))
    wide = np.concatenate([wide[:, -1:], wide, wide[:, :1]], axis=1)
    for dy, dx in ((0, 1), (2, 1), (1, 0), (1, 2)):
        moved = wide[dy : dy + height, dx : dx + pixels.shape[1]]
        brightest = np.maximum(brightest, moved.reshape(shape).max(axis=(1, 3)))
    order = np.argsort(brightest, axis=None)[::-1][:SQUARES]
    places = np.stack(np.unravel_index(order, brightest.shape), axis=1)
    return [tuple(map(int, place)) for place in places if brightest[tuple(place)] > MUCH]


def bake(job):
    scene = prepare(job)
    width = job["width"]
    look_around(scene, width)
    render = scene.render
    render.use_border = False
    pixels = rendered(scene, SAMPLES)
    render.use_border = render.use_crop_to_border = True
    height = width // 2
    for row, column in bright_squares(pixels):
        top, left = row * SQUARE, column * SQUARE
        render.border_min_x, render.border_max_x = left / width, (left + SQUARE) / width
        render.border_min_y = 1.0 - (top + SQUARE) / height
        render.border_max_y = 1.0 - top / height
        square = rendered(scene, SAMPLES_OF_SQUARE)
        if square.shape == (SQUARE, SQUARE, 3):
            pixels[top : top + SQUARE, left : left + SQUARE] = square
    np.save(job["output"], pixels)


def main():
    for line in sys.stdin:
        try:
            bake(json.loads(line))
            answer = "done"
        except Exception as error:
            answer = f"error {error}".replace("\n", " ")
        bpy.ops.wm.read_factory_settings(use_empty=True)
        print("\n" + ANSWER + answer, flush=True)


if __name__ == "__main__":
    main()
