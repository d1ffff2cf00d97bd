"""Twelve worlds: how the add-on follows each, against a bake and against Cycles' own light.

blender -b --factory-startup --python-use-system-env --python worlds.py -- FOLDER

FOLDER gets pictures that are made here. For each world, the light of a ball's vertices is compared
with that under a bake of the world, and with a white ball that Cycles draws. Cycles has noise, so
there the smooth part counts: polynomials of the normal up to degree 3.
"""

import os
import sys

import bpy
import numpy as np
from mathutils import Matrix, Vector, kdtree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import addon

relumine_lights = addon.load()
from relumine_lights import assets, worlds

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
#: Relative L2, of bakes and of Cycles.
LIMIT = 0.01
#: A sky with a sun, by the name that this Blender has for it.
SKY = "NISHITA" if bpy.app.version < (5, 0, 0) else "SINGLE_SCATTERING"


def picture(name, *, seed=1, width=256, float_buffer=True, path=None, image_format="OPEN_EXR"):
    """A sky with two lamps, as an image that is saved where there is a path."""
    height = width // 2
    v, u = np.mgrid[0:height, 0:width]
    z, angle = (v + 0.5) / height * np.pi, np.pi - (u + 0.5) / width * 2 * np.pi
    w = np.stack([np.sin(z) * np.cos(angle), np.sin(z) * np.sin(angle), -np.cos(z)], axis=-1)
    rng = np.random.default_rng(seed)
    color = 0.2 + 0.15 * w[..., 2:] * [0.4, 0.7, 1.0]
    for _ in range(2):
        lamp = rng.normal(size=3)
        power = np.clip(w @ (lamp / np.linalg.norm(lamp)), 0, 1) ** 40
        color = color + power[..., None] * rng.uniform(0.2, 0.8 if not float_buffer else 6.0, 3)
    image = bpy.data.images.new(name, width, height, float_buffer=float_buffer)
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :3] = color if float_buffer else np.clip(color, 0, 1)
    image.pixels.foreach_set(rgba.ravel())
    if path is None:
        return image
    image.filepath_raw, image.file_format = path, image_format
    image.save()
    bpy.data.images.remove(image)
    return bpy.data.images.load(path)


class Nodes:
    """A new world with a background that shines."""

    def __init__(self, strength=1.0):
        self.world = bpy.context.scene.world = bpy.data.worlds.new("world")
        self.world.use_nodes = True
        # How Cycles chooses directions; what it makes by itself takes a second for each picture.
        self.world.cycles.sampling_method, self.world.cycles.sample_map_resolution = "MANUAL", 256
        self.tree = self.world.node_tree
        self.background = next(node for node in self.tree.nodes if node.type == "BACKGROUND")
        self.background.inputs["Strength"].default_value = strength
        self.output = next(node for node in self.tree.nodes if node.type == "OUTPUT_WORLD")

    def add(self, kind, **values):
        node = self.tree.nodes.new("ShaderNode" + kind)
        for name, value in values.items():
            setattr(node, name, value)
        return node

    def link(self, source, target):
        self.tree.links.new(source, target)

    def shine(self, node):
        self.link(node.outputs["Color"], self.background.inputs["Color"])

    def mapped(self, texture, *, rotation=(0, 0, 0), scale=(1, 1, 1)):
        mapping, coordinates = self.add("Mapping"), self.add("TexCoord")
        mapping.inputs["Rotation"].default_value = rotation
        mapping.inputs["Scale"].default_value = scale
        self.link(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        self.link(mapping.outputs["Vector"], texture.inputs["Vector"])
        return mapping


def hdri():
    nodes = Nodes(1.5)
    texture = nodes.add("TexEnvironment")
    texture.image = picture("hdri", path=os.path.join(folder, "hdri.exr"))
    nodes.shine(texture)
    return nodes, texture


def sky():
    nodes = Nodes(0.3)
    nodes.shine(nodes.add("TexSky", sky_type=SKY, sun_elevation=0.6, sun_rotation=1.0))


def mix():
    nodes, texture = hdri()
    other, mixer = nodes.add("Background"), nodes.add("MixShader")
    other.inputs["Color"].default_value = (0.1, 0.4, 0.9, 1.0)
    mixer.inputs[0].default_value = 0.3
    nodes.link(nodes.background.outputs[0], mixer.inputs[1])
    nodes.link(other.outputs[0], mixer.inputs[2])
    nodes.link(mixer.outputs[0], nodes.output.inputs["Surface"])


def hue():
    nodes, texture = hdri()
    change = nodes.add("HueSaturation")
    change.inputs["Hue"].default_value, change.inputs["Saturation"].default_value = 0.7, 1.6
    nodes.link(texture.outputs["Color"], change.inputs["Color"])
    nodes.shine(change)


def turned_hue():
    """A bake that turns live."""
    hue()
    nodes = bpy.context.scene.world.node_tree.nodes
    tree = bpy.context.scene.world.node_tree
    mapping, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], nodes["Environment Texture"].inputs["Vector"])
    bpy.context.view_layer.update()
    mapping.inputs["Rotation"].default_value = (0.5, -0.4, 1.2)


def mirrored():
    nodes, texture = hdri()
    nodes.mapped(texture, scale=(1, -1, 1), rotation=(0, 0, 0.4))


def mirror_ball():
    nodes, texture = hdri()
    texture.projection = "MIRROR_BALL"
    texture.image = picture("square", path=os.path.join(folder, "square.exr"))


def packed():
    nodes, texture = hdri()
    texture.image.pack()


def generated():
    nodes, texture = hdri()
    texture.image = picture("painted", seed=7)


def srgb():
    nodes, texture = hdri()
    texture.image = picture("srgb", float_buffer=False, path=os.path.join(folder, "srgb.png"),
                            image_format="PNG")  # fmt: skip


def color():
    Nodes(2.0).background.inputs["Color"].default_value = (0.2, 0.5, 0.8, 1.0)


def light_path():
    nodes, texture = hdri()
    shown, mixer, path = nodes.add("Background"), nodes.add("MixShader"), nodes.add("LightPath")
    shown.inputs["Color"].default_value = (5.0, 0.0, 5.0, 1.0)
    nodes.link(path.outputs["Is Camera Ray"], mixer.inputs[0])
    nodes.link(nodes.background.outputs[0], mixer.inputs[1])
    nodes.link(shown.outputs[0], mixer.inputs[2])
    nodes.link(mixer.outputs[0], nodes.output.inputs["Surface"])


def rotated():
    nodes, texture = hdri()
    nodes.mapped(texture, rotation=(0.9, 0.3, 0.5))


def video():
    scene = bpy.context.scene
    nodes, texture = hdri()
    for frame in (1, 2, 3):
        picture("frame", seed=frame, float_buffer=False, image_format="PNG",
                path=os.path.join(folder, f"frame{frame}.png"))  # fmt: skip
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences  # until Blender 4.3
    strip = strips.new_image("frames", os.path.join(folder, "frame1.png"), 1, 1)
    for frame in (2, 3):
        strip.elements.append(f"frame{frame}.png")
    strip.frame_final_duration = 3
    render = scene.render
    render.filepath = os.path.join(folder, "video_")
    if hasattr(render.image_settings, "media_type"):  # since Blender 5
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "AVI", "FFV1"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 256, 128, 100
    scene.view_settings.view_transform = "Standard"
    scene.frame_start, scene.frame_end = 1, 3
    bpy.ops.render.render(animation=True)
    scene.sequence_editor_clear()
    path = next(each for each in os.listdir(folder) if each.startswith("video_"))
    texture.image = bpy.data.images.load(os.path.join(folder, path))
    texture.image_user.frame_duration = 3
    texture.image_user.use_auto_refresh = True
    scene.frame_set(2)


WORLDS = {"HDRI": hdri, "Sky Texture, sun": sky, "Mix Shader": mix, "Hue/Saturation": hue,
          "the same, turned live": turned_hue, "mapping, scale -1": mirrored,
          "mirror ball": mirror_ball, "packed": packed,
          "generated": generated, "sRGB": srgb, "colour": color, "light-path trick": light_path,
          "rotated in X, Y, Z": rotated, "video": video}  # fmt: skip


def colors_of(thing, name):
    data = thing.data.color_attributes[name].data
    values = np.empty(4 * len(data), dtype=np.float32)
    data.foreach_get("color", values)
    return values.reshape(-1, 4)[:, :3].astype(np.float64)


def ball(name):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5)
    thing = bpy.context.object
    thing.name = name
    bpy.ops.object.shade_smooth()
    return thing


def by_cycles(thing):
    """Normals (N, 3) and radiance (N, 3) of a white ball as Cycles draws it from four sides."""
    scene, render = bpy.context.scene, bpy.context.scene.render
    render.engine, scene.cycles.samples = "CYCLES", 256
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.cycles.film_exposure = "BOX", 1.0
    render.resolution_x = render.resolution_y = size = 24
    render.resolution_percentage = 100
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = os.path.join(folder, "ball.exr")
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.type, camera.data.ortho_scale = camera, "ORTHO", 2.0
    for other in scene.objects:
        other.hide_render = other not in (thing, camera)
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / size * 2 - 1
    inside = np.hypot(x, y) < 0.92
    local = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[inside]
    normals, values = [], []
    for axis in np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3):
        camera.rotation_euler = Vector(axis).to_track_quat("Z", "Y").to_euler()
        camera.location = 5.0 * axis
        bpy.context.view_layer.update()
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        pixels = np.empty(size * size * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
        values.append(pixels.reshape(size, size, 4)[inside][:, :3])
        normals.append(local @ np.array(camera.matrix_world)[:3, :3].T)
    bpy.data.objects.remove(camera)
    return np.concatenate(normals), np.concatenate(values).astype(np.float64)


def harmonics(normals):
    """Real polynomials that span spherical harmonics up to order 3."""
    x, y, z = normals.T
    powers = [(i, j, k) for i in range(4) for j in range(4 - i) for k in (0, 1) if i + j + k <= 3]
    return np.stack([x**i * y**j * z**k for i, j, k in powers], axis=1)


def smooth(normals, values):
    basis = harmonics(normals)
    return basis @ np.linalg.lstsq(basis, values, rcond=None)[0]


def at_normals(tree, wanted, values):
    """Values of a ball's vertices, which a tree has by their normals, at other normals."""
    result = []
    for normal in wanted:
        found = tree.find_n(normal, 3)
        weights = np.array([1.0 / (distance + 1e-6) for _, _, distance in found])
        result.append(weights @ values[[index for _, index, _ in found]] / weights.sum())
    return np.array(result)


def difference(a, b):
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def under_bake(scene, thing, number):
    """The light of an asset under a bake of the whole world."""
    light = worlds.WorldLight(scene, bpy.context.evaluated_depsgraph_get())
    light.kind, light.turn, light.strength = "baked", Matrix.Identity(3), 1.0
    light._turned_by = light._strength_of = ""
    light.key = ("forced", number)
    live = assets.LiveScene(assets.path_of(thing))
    live.light(light, [], scene.relumine.face_resolution, wait=True)
    return live.radiance.astype(np.float64)


def follows_changes(scene, thing):
    """Another frame, another tree; and what is not followed is said."""
    before = colors_of(thing, "Relumine")
    scene.frame_set(3)
    assert difference(colors_of(thing, "Relumine"), before) > 0.01
    hue()
    bpy.context.view_layer.update()
    before = colors_of(thing, "Relumine")
    node = next(each for each in scene.world.node_tree.nodes if each.type == "HUE_SAT")
    node.inputs["Value"].default_value = 2.0
    bpy.context.view_layer.update()
    assert difference(colors_of(thing, "Relumine"), 2.0 * before) < 1e-3
    tree = scene.world.node_tree
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Window"], tree.nodes["Environment Texture"].inputs[0])
    bpy.context.view_layer.update()
    assert assets.remarks == ["Texture Coordinate: coordinates of a camera are not followed"]


def main():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.relumine.tolerance = 0.01
    reference = ball("reference")
    white = bpy.data.materials.new("white")
    white.use_nodes = True
    surface = white.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    surface.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = next(node for node in white.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    white.node_tree.links.new(surface.outputs[0], output.inputs["Surface"])
    reference.data.materials.append(white)
    reference.hide_render = True
    thing = ball("ball")
    reference.select_set(False)
    assert bpy.ops.relumine.precompute(filepath=os.path.join(folder, "ball.prt")) == {"FINISHED"}
    tree = kdtree.KDTree(len(thing.data.vertices))
    for vertex in thing.data.vertices:
        tree.insert(vertex.normal, vertex.index)
    tree.balance()
    wrong = []
    print(f"{'world':22}  {'way':7}  {'against a bake':>14}  {'against Cycles':>14}")
    for number, (name, make) in enumerate(WORLDS.items()):
        scene.frame_set(1)
        make()
        bpy.context.view_layer.update()
        assert scene.relumine.error == "", (name, scene.relumine.error)
        assert not assets.remarks, (name, assets.remarks)
        light = worlds.WorldLight(scene, bpy.context.evaluated_depsgraph_get())
        ours = colors_of(thing, "Relumine")
        is_bake = light.kind == "baked" and not light.is_turned_live
        of_bake = 0.0 if is_bake else difference(ours, under_bake(scene, thing, number))
        normals, truth = by_cycles(reference)
        seen = at_normals(tree, normals, ours)
        of_cycles = difference(smooth(normals, seen), smooth(normals, truth))
        way = "baked" if light.kind == "baked" else "live"
        against = "is one" if is_bake else f"{100 * of_bake:.3f} %"
        print(f"{name:22}  {way:7}  {against:>14}  {100 * of_cycles:12.2f} %", flush=True)
        if of_bake > LIMIT or of_cycles > LIMIT:
            wrong.append(name)
    assert not wrong, wrong
    follows_changes(scene, thing)
    relumine_lights.unregister()
    print(f"worlds in Blender {bpy.app.version_string}")
    print("all is well")


if __name__ == "__main__":
    main()
