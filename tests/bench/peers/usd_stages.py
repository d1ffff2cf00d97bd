"""Stages of USD against Cycles: the same stage, dome and camera, each by its own importer.

    python usd_stages.py ENVIRONMENT STAGE... --blender PYTHON [--keep FOLDER] [--samples 64]

PYTHON has bpy, this one relumine[usd] and pillow. ENVIRONMENT is a lat-long. Lights of the stages
are left out. Prints how far the pictures of the stage's meshes differ, of 255 in sRGB.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import warnings

import numpy as np

SIZE = 192
FOV = 35.0


def cycles(environment, stage, camera, subdivides, samples, output):
    """Runs in a process of its own: this file without --blender."""
    import bpy
    import mathutils

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=stage, import_lights=False, import_cameras=False, create_world_material=False, import_subdiv=subdivides)
    scene = bpy.context.scene
    scene.frame_set(scene.frame_start)
    # findings/blender_usd_shared_image.sh
    for material in bpy.data.materials:
        for link in material.node_tree.links if material.node_tree else ():
            if link.to_socket.name == "Base Color" and link.from_node.type == "TEX_IMAGE" and link.from_node.image:
                link.from_node.image.colorspace_settings.name = "sRGB"
    world = scene.world = bpy.data.worlds.new("dome")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    texture, mapping, place = (nodes.new(f"ShaderNode{name}") for name in ("TexEnvironment", "Mapping", "TexCoord"))
    texture.image = bpy.data.images.load(environment)
    # The middle of a lat-long is +X in Blender, and here +Z, which is -Y there.
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, np.pi / 2)
    links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], nodes["Background"].inputs["Color"])
    view = bpy.data.cameras.new("view")
    view.angle, view.clip_start, view.clip_end = np.radians(FOV), 1e-5, 1e7
    scene.camera = bpy.data.objects.new("view", view)
    scene.collection.objects.link(scene.camera)
    eye, target = (mathutils.Vector((p[0], -p[2], p[1])) for p in camera)
    scene.camera.rotation_mode = "QUATERNION"
    scene.camera.location = eye
    scene.camera.rotation_quaternion = (target - eye).to_track_quat("-Z", "Y")
    scene.render.engine = "CYCLES"
    made = scene.cycles
    made.samples, made.use_denoising, made.use_adaptive_sampling = samples, True, False
    made.sample_clamp_indirect = 0.0
    made.max_bounces = made.diffuse_bounces = made.glossy_bounces = made.transmission_bounces = 16
    made.transparent_max_bounces = 64
    scene.render.film_transparent = True
    made.pixel_filter_type = "BOX"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode, scene.render.image_settings.color_depth = "RGBA", "32"
    scene.render.filepath = output
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(output)
    pixels = np.empty(4 * SIZE * SIZE, np.float32)
    image.pixels.foreach_get(pixels)
    np.save(output, pixels.reshape(SIZE, SIZE, 4)[::-1])


def camera_of(mesh):
    low, high = mesh.vertices.min(0), mesh.vertices.max(0)
    middle = np.add((low + high) / 2, mesh.offset)
    size = float(np.linalg.norm(high - low))
    return (middle + size * np.array([0.7, 0.5, 1.2])).tolist(), middle.tolist()


def srgb(picture):
    x = np.clip(picture[..., :3], 0.0, 1.0)
    return 255.0 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("environment", type=pathlib.Path)
    parser.add_argument("stages", type=pathlib.Path, nargs="+")
    parser.add_argument("--blender", required=True)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=64)
    options = parser.parse_args()
    import relumine
    import relumine.usd
    from PIL import Image

    folder = options.keep or pathlib.Path(tempfile.mkdtemp())
    folder.mkdir(exist_ok=True)
    errors = []
    for stage in options.stages:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            asset = relumine.usd.load(stage, lights=False)
            camera = camera_of(asset.mesh)
            lit = relumine.Relighter(relumine.precompute(asset.mesh, bounces=True, tolerance=0.05))
            lit.set_environment(relumine.Environment.load(options.environment))
            lit.bounce()
            ours = np.asarray(lit.picture(size=(SIZE, SIZE), eye=camera[0], target=camera[1], fov=FOV, background="none", exposure=0))
        output = folder / f"{stage.stem}.exr"
        # Where a mesh with normals names no scheme, ours are polygons.
        subdivides = int(not any("scheme" in note for note in asset.notes))
        child = [options.blender, __file__, options.environment, stage, json.dumps(camera), subdivides, options.samples, output]
        subprocess.run([str(part) for part in child], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        theirs = np.load(f"{output}.npy")
        # The brightest tenth of the surfaces is white.
        gain = 1.0 / np.quantile(theirs[theirs[..., 3] > 0.99][:, :3].max(1), 0.9)
        pictures = [srgb(gain * picture) for picture in (ours, theirs)]
        seen = np.maximum(ours[..., 3], theirs[..., 3]) > 0.5
        error = np.abs(pictures[0] - pictures[1])[seen].mean()
        errors.append(error)
        Image.fromarray(np.concatenate(pictures, 1).round().astype(np.uint8)).save(folder / f"{stage.stem}.png")
        print(f"{stage.name:44} {error:6.2f} {np.mean((ours[..., 3] > 0.5) != (theirs[..., 3] > 0.5)):8.2%}", flush=True)
    print(f"median {np.median(errors):.2f} of {len(errors)}")


if len(sys.argv) == 7 and "--blender" not in sys.argv:
    cycles(sys.argv[1], sys.argv[2], json.loads(sys.argv[3]), bool(int(sys.argv[4])), int(sys.argv[5]), sys.argv[6])
else:
    main()
