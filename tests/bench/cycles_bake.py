"""Inside of Blender: the light of a mesh's vertices, by Cycles.

    blender -b --factory-startup -P cycles_bake.py -- MESH.ply ENV.exr SAMPLES BOUNCES ALBEDO OUT.npy [NORMALS.npy]

The environment is as Blender reads it, all others as Relumine writes them. Prints "baked in SECONDS
processor SECONDS".
"""
import sys
import time

import bpy
import numpy


def bake(mesh_file, environment, samples, bounces, albedo, output, normals=None):
    """Bakes the light of white surfaces' vertices among others of `albedo`. `normals` is a .npy; without, Blender has its own."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_mesh.ply(filepath=mesh_file)
    thing = bpy.context.selected_objects[0]
    bpy.context.view_layer.objects.active = thing
    mesh = thing.data
    positions = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", positions)
    x, y, z = positions.reshape(-1, 3).T
    mesh.vertices.foreach_set("co", numpy.stack([x, -z, y], axis=1).ravel())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.update()
    if normals is not None:
        x, y, z = numpy.load(normals).T
        mesh.use_auto_smooth = True
        mesh.normals_split_custom_set_from_vertices(numpy.stack([x, -z, y], axis=1))

    material = bpy.data.materials.new("plain")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (albedo, albedo, albedo, 1.0)
    surface = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(diffuse.outputs["BSDF"], surface.inputs["Surface"])
    mesh.materials.clear()
    mesh.materials.append(material)

    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    nodes = scene.world.node_tree.nodes
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(environment)
    scene.world.node_tree.links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])

    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    layer = mesh.color_attributes.new(name="light", type="FLOAT_COLOR", domain="POINT")
    mesh.color_attributes.active_color = layer
    start, processor = time.perf_counter(), time.process_time()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, target="VERTEX_COLORS")
    seconds = time.perf_counter() - start
    colors = numpy.empty(4 * len(mesh.vertices), dtype=numpy.float32)
    layer.data.foreach_get("color", colors)
    numpy.save(output, colors.reshape(-1, 4)[:, :3])
    print("baked in", seconds, "processor", time.process_time() - processor)


words = sys.argv[sys.argv.index("--") + 1:]
bake(words[0], words[1], int(words[2]), int(words[3]), float(words[4]), *words[5:])
