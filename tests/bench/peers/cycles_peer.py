"""Cycles, through the package bpy: Blender's path tracer."""
import contextlib
import os
import tempfile

import bpy
import mathutils
import numpy as np
import OpenEXR

from scenes import axes_of, dome_of

NAME = "Cycles"
#: Blender's world has +Z up: rows of what takes our directions to its.
WORLD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
#: The middle of a lat-long is +X of Blender's world, and +Z (Blender's -Y) of ours.
DOME = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def version():
    return bpy.app.version_string


@contextlib.contextmanager
def _temporary_exr():
    with tempfile.TemporaryDirectory() as folder:
        yield os.path.join(folder, "picture.exr")


def _material(given):
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    color = (*given["color"], 1.0)
    kind = given["kind"]
    if any(given["glow"]):
        shader = nodes.new("ShaderNodeEmission")
        shader.inputs["Color"].default_value = (*given["glow"], 1.0)
        shader.inputs["Strength"].default_value = 1.0
    elif kind == "glass":
        shader = nodes.new("ShaderNodeBsdfGlass")
        shader.inputs["Roughness"].default_value = 0.0
        shader.inputs["IOR"].default_value = given["ior"]
        shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    elif kind == "matte" and not given["coat"] and not any(given["sheen"]):
        shader = nodes.new("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = color
        shader.inputs["Roughness"].default_value = 0.0
    else:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        for name, value in {
            "Base Color": color, "Metallic": 1.0 if kind == "metal" else 0.0, "Roughness": given["roughness"], "IOR": given["ior"],
            "Specular IOR Level": 0.0 if kind == "matte" else 0.5, "Coat Weight": given["coat"], "Coat Roughness": 0.0,
            "Sheen Weight": max(given["sheen"]), "Sheen Roughness": given["sheen_roughness"],
        }.items():  # fmt: skip
            shader.inputs[name].default_value = value
    links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def _mesh(given):
    mesh = bpy.data.meshes.new("shape")
    mesh.from_pydata((given["vertices"] @ WORLD.T).tolist(), [], given["triangles"].tolist())
    if given["normals"] is not None:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.normals_split_custom_set_from_vertices((given["normals"] @ WORLD.T).tolist())
    mesh.materials.append(_material(given["material"]))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("shape", mesh))


class State:
    pass


def build(scene):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    state = State()
    for each in scene["shapes"]:
        _mesh(each)
    made = bpy.context.scene
    made.render.engine = "CYCLES"
    cycles = made.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.pixel_filter_type = "BOX"
    bounces = 1024 if scene["bounces"] is None else scene["bounces"]
    if any(each["material"]["kind"] == "glass" for each in scene["shapes"]):
        bounces = 1024
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    # A file with all passes; Blender 5 asks for the medium first.
    made.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    made.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    made.render.image_settings.color_depth = "32"
    made.render.use_persistent_data = True
    state.seed = 0
    state.lights = []
    view = bpy.data.cameras.new("camera")
    view.sensor_fit = "VERTICAL"
    made.camera = bpy.data.objects.new("camera", view)
    made.collection.objects.link(made.camera)
    look(state, scene["camera"])
    relight(state, scene["light"])
    return state


def _world(light):
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    dome = dome_of(light)
    if dome is None:
        return world
    height, width, _ = dome.shape
    image = bpy.data.images.new("dome", width, height, float_buffer=True)
    image.colorspace_settings.name = "Linear Rec.709"
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = dome[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    texture, mapping, place = (nodes.new(f"ShaderNode{name}") for name in ("TexEnvironment", "Mapping", "TexCoord"))
    texture.image = image
    mapping.vector_type = "POINT"
    # The node turns the direction that is looked up: against the dome.
    turn = (WORLD @ light["turn"] @ WORLD.T @ DOME.T).T
    mapping.inputs["Rotation"].default_value = mathutils.Matrix(turn.tolist()).to_euler("XYZ")
    links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], background.inputs["Color"])
    return world


def _add_light(state, kind, color, **settings):
    data = bpy.data.lights.new(kind, kind)
    strength = max(color)
    data.color = [each / strength for each in color]
    data.energy = strength
    for name, value in settings.items():
        setattr(data, name, value)
    thing = bpy.data.objects.new(kind, data)
    bpy.context.scene.collection.objects.link(thing)
    state.lights.append(thing)
    return thing


def relight(state, light):
    for each in state.lights:
        bpy.data.objects.remove(each)
    state.lights = []
    bpy.context.scene.world = _world(light)
    for sun in light["suns"]:
        thing = _add_light(state, "SUN", sun["irradiance"], angle=0.0)
        thing.rotation_mode = "QUATERNION"
        thing.rotation_quaternion = mathutils.Vector((WORLD @ np.asarray(sun["direction"], float)).tolist()).to_track_quat("Z", "Y")
    for lamp in light["lamps"]:
        # A lamp of 1 W has an intensity of 1 / (4 pi) W/sr.
        thing = _add_light(state, "POINT", [4 * np.pi * each for each in lamp["intensity"]], shadow_soft_size=0.0)
        thing.lightgroup = f"lamp{len(state.lights)}"
        thing.location = (WORLD @ np.asarray(lamp["position"], float)).tolist()


def look(state, camera):
    thing = bpy.context.scene.camera
    thing.data.angle = np.radians(camera["fov"])
    thing.data.clip_start, thing.data.clip_end = 1e-4, 1e5
    turn = WORLD @ np.stack(axes_of(camera), axis=1)
    thing.matrix_world = mathutils.Matrix.LocRotScale(
        mathutils.Vector((WORLD @ np.asarray(camera["eye"])).tolist()), mathutils.Matrix(turn.tolist()), None
    )
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = camera["size"]


def picture(state, samples):
    return _rendered(state, samples, ["Combined"])[0]


def groups(state, samples):
    """Renders a picture of each lamp and one of all other lights, for mixed()."""
    names = ["rest", *(thing.lightgroup for thing in state.lights if thing.lightgroup not in ("", "rest"))]
    made = bpy.context.view_layer
    for thing in [*state.lights, bpy.context.scene.world]:
        thing.lightgroup = thing.lightgroup or "rest"
    for name in names:
        made.lightgroups.add(name=name)
    state.groups = _rendered(state, samples, [f"Combined_{name}" for name in names])
    while made.lightgroups:
        made.active_lightgroup_index = 0
        bpy.ops.scene.view_layer_remove_lightgroup()


def mixed(state, factors):
    """The picture with the groups times factors: that of the other lights, then those of the lamps."""
    return sum(picture * np.asarray(factor, np.float32) for picture, factor in zip(state.groups, factors))


def _rendered(state, samples, passes):
    """The wanted passes of a picture."""
    made = bpy.context.scene
    state.seed += 1
    made.cycles.seed = state.seed
    made.cycles.samples = samples
    with _temporary_exr() as path:
        made.render.filepath = path
        bpy.ops.render.render(write_still=True)
        layer = bpy.context.view_layer.name
        with OpenEXR.File(path, separate_channels=True) as file:
            channels = {name: np.asarray(channel.pixels, np.float32) for part in file.parts for name, channel in part.channels.items()}
        return [np.stack([channels[f"{layer}.{name}.{each}"] for each in "RGB"], -1) for name in passes]
