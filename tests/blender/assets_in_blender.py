"""Runs in `blender -b`: assets, their files and what changes them; lamps, materials, lightmaps.
FOLDER follows `--`."""

import contextlib
import io
import os
import sys
import traceback

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import addon

relumine_lights = addon.load()
from relumine_lights import assets, materials

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])


def colors(thing):
    data = thing.data.color_attributes["Relumine"].data
    values = np.empty(4 * len(data), dtype=np.float32)
    data.foreach_get("color", values)
    return values.reshape(-1, 4)[:, :3]


def update():
    bpy.context.view_layer.update()


def shine(world, color):
    """Makes a world even."""
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = False
        world.color = color
        return
    # Worlds always have nodes.
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = 1.0


def clear(color=(1.0, 1.0, 1.0)):
    """An empty scene under an even world."""
    for each in (*bpy.data.objects, *bpy.data.meshes):
        (bpy.data.objects if isinstance(each, bpy.types.Object) else bpy.data.meshes).remove(each)
    scene = bpy.context.scene
    scene.world = scene.world or bpy.data.worlds.new("world")
    shine(scene.world, color)
    settings = scene.relumine
    settings.tolerance, settings.face_resolution, settings.bounces = 0.03, 16, False
    settings.receivers = "VERTICES"
    update()
    return scene


def plane(name, size=2.0, cuts=9, **where):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=size, **where)
    bpy.context.object.name = name
    return bpy.context.object


def select(*things):
    for thing in bpy.context.scene.objects:
        thing.select_set(thing in things)
    bpy.context.view_layer.objects.active = things[0]


def precompute(*things, **options):
    select(*things)
    return bpy.ops.relumine.precompute(**options)


def refusal(call):
    try:
        call()
    except RuntimeError as error:
        return str(error)
    raise AssertionError("expected an error, got none")


def reports(call):
    """What an operator says; Blender repeats it in the terminal."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        call()
    return said.getvalue()


def states():
    update()
    return dict(assets.look_for_changes(bpy.context.scene))


def test_each_asset_has_a_file():
    scene = clear()
    floor, ball = plane("floor"), None
    bpy.ops.mesh.primitive_uv_sphere_add(location=(9, 0, 0))
    ball = bpy.context.object
    ball.name = "ball"
    assert precompute(floor) == {"FINISHED"} and precompute(ball) == {"FINISHED"}
    assert (floor["relumine_prt"], ball["relumine_prt"]) == ("//floor.prt", "//ball.prt")
    assert np.allclose(colors(floor), 1.0, atol=0.02) and np.allclose(colors(ball), 1.0, atol=0.02)
    assert "file of its own" in refusal(lambda: precompute(ball, filepath="//floor.prt"))
    # Another mesh's file in its place: no light of it, and a line that says so.
    os.replace("floor.prt", "kept.prt")
    os.replace("ball.prt", "floor.prt")
    before = colors(floor)
    shine(scene.world, (0.25, 0.5, 0.5))
    update()
    assert "expected the light of floor, got another mesh's" in scene.relumine.error
    assert "ball.prt: cannot read" in scene.relumine.error and (colors(floor) == before).all()
    os.replace("floor.prt", "ball.prt")
    os.replace("kept.prt", "floor.prt")
    bpy.ops.relumine.update()
    assert scene.relumine.error == "" and np.allclose(colors(floor)[:, 0], 0.25, atol=0.01)
    assert np.allclose(colors(ball)[:, 0], 0.25, atol=0.01)


def test_changes_are_seen():
    clear()
    floor, other = plane("floor"), plane("other", location=(0, 0, 5))
    precompute(floor)
    assert states() == {}
    floor.location.x = 1.0
    assert states() == {"floor": "stale: place changed"}
    floor.location.x = 0.0
    assert states() == {}
    modifier = floor.modifiers.new("wave", "DISPLACE")
    modifier.strength = 0.3
    assert states() == {"floor": "stale: mesh or modifiers changed"}
    floor.modifiers.remove(modifier)
    assert states() == {}
    floor.data.vertices[0].co.z += 0.5
    floor.data.update()
    assert states() == {"floor": "stale: mesh or modifiers changed"}
    floor.data.vertices[0].co.z -= 0.5
    floor.data.update()
    other.location.z = 4.0
    assert states() == {"floor": "stale: what is around changed"}
    select(floor)
    assert bpy.ops.relumine.precompute(again=True) == {"FINISHED"}
    assert states() == {}
    # Objects of one asset shadow each other.
    third = plane("third", location=(0, 3, 0))
    assert precompute(floor, third) == {"FINISHED"} and states() == {}
    third.location.z = 1.0
    assert states() == {"third": "stale: place changed", "floor": "stale: third changed"}
    third.location.z = 0.0
    # The same after the file was saved and opened.
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "assets.blend"))
    bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "assets.blend"))
    assert states() == {}
    bpy.data.objects["other"].location.x = 3.0
    assert set(states().values()) == {"stale: what is around changed"}


def test_light_follows_an_object_that_moves():
    for bounces in (False, True):
        scene = clear()
        scene.relumine.bounces = bounces
        floor, roof = plane("floor"), plane("roof", size=1.0, location=(0.2, 0, 0.4))
        plane("wall", location=(0, 0, -3))  # around
        assert precompute(floor, roof) == {"FINISHED"}
        with open("floor.prt" if os.path.exists("floor.prt") else "roof.prt", "rb") as file:
            before = file.read()
        first = colors(floor)
        roof.location.x = -0.5
        roof.rotation_euler.z = 0.3
        assert states() == {"roof": "stale: place changed", "floor": "stale: roof changed"}
        assert bpy.ops.relumine.update() == {"FINISHED"} and states() == {}
        moved = colors(floor)
        assert abs(moved - first).max() > 0.1
        # A sun's light follows, too.
        bpy.ops.object.light_add(type="SUN", location=(0, 0, 5))
        sun = bpy.context.object
        update()
        under_sun = colors(floor)
        assert (under_sun > moved + 0.1).any()
        roof.location.x = 0.2
        roof.rotation_euler.z = 0.0
        update()
        assets.relight_quietly(scene)
        assert states() == {} and abs(colors(floor) - under_sun).max() > 0.1
        bpy.data.objects.remove(sun)
        update()
        assert abs(colors(floor) - first).max() < 1e-4, "back where it stood"
        # The file stays as it was; another precompute says the same.
        with open("floor.prt" if os.path.exists("floor.prt") else "roof.prt", "rb") as file:
            assert file.read() == before
        roof.location.x = -0.5
        roof.rotation_euler.z = 0.3
        update()
        select(floor, roof)
        assert bpy.ops.relumine.precompute(again=True) == {"FINISHED"}
        assert abs(colors(floor) - moved).mean() < 0.02 and states() == {}
        # What cannot follow says why.
        roof.scale.x = -1.0
        update()
        bpy.ops.relumine.update()
        assert "place changed (expected a matrix that turns and moves" in states()["roof"]


def test_light_follows_all_that_moved_in_one_go():
    scene = clear()
    floor, roofs = plane("ground", size=4.0, cuts=15), []
    for i in range(3):
        roofs.append(plane(f"lid {i}", size=0.6, location=(i - 1.0, 0, 0.4)))
    assert precompute(floor, *roofs) == {"FINISHED"}
    first, live = colors(floor), assets.live_scene(assets.path_of(floor))
    calls, move = [], live.world.move
    live.world.move = lambda ways, **how: (calls.append(len(ways)), move(ways, **how))
    for roof in roofs:
        roof.location.y = 0.8
    update()
    # Beside the user's work: the light stays until it is there, and is not called stale.
    assets.relight(scene, wait=False)
    assert str(assets.followings()[0]).startswith("Light follows lid 0, lid 1, lid 2: ")
    stale = states()
    assert stale == {} and (colors(floor) == first).all(), stale
    assets.followings()[0]._thread.join()
    assets.relight(scene, wait=False)
    assert calls == [3] and not assets.followings() and states() == {}
    moved = colors(floor)
    assert abs(moved - first).max() > 0.1
    assert assets.followed(floor).startswith("Light followed lid 0, lid 1, lid 2 in ")
    # One that cannot follow does not keep the others.
    for roof in roofs:
        roof.location.y = 0.0
    roofs[1].scale.x = -1.0
    update()
    told = []
    assets.relight(scene, wait=True, progress=told.append)
    assert told and max(told) <= 1.0
    assert set(states()) == {"lid 1", "ground", "lid 0", "lid 2"}
    assert "mirrors" in states()["lid 1"] and abs(colors(floor) - moved).max() > 0.1
    roofs[1].scale.x = 1.0
    update()
    assets.relight(scene, wait=True)
    assert states() == {} and abs(colors(floor) - first).max() < 1e-4


def test_what_renders_blocks_light():
    clear()
    floor = plane("floor")
    precompute(floor)
    open_light = colors(floor).mean()
    roof = plane("roof", size=6.0, location=(0, 0, 0.5))
    precompute(floor)
    covered = colors(floor).mean()
    assert covered < 0.5 * open_light, (covered, open_light)
    roof.hide_render = True
    precompute(floor)
    assert np.isclose(colors(floor).mean(), open_light, rtol=1e-3)
    # An instance of a collection that is in no scene.
    collection = bpy.data.collections.new("roofs")
    roof.users_collection[0].objects.unlink(roof)
    collection.objects.link(roof)
    roof.hide_render = False
    empty = bpy.data.objects.new("instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    update()
    precompute(floor)
    assert np.isclose(colors(floor).mean(), covered, rtol=1e-3)
    empty.location.z = 3.0
    assert "what is around" in states()["floor"]


def test_copies():
    scene = clear()
    floor = plane("floor")
    precompute(floor)
    select(floor)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    copy.location.x = 5.0
    shine(scene.world, (0.5, 0.5, 0.5))
    update()
    assert states()[copy.name] == "a copy of floor: precompute it"
    assert "Relumine" not in copy.data.color_attributes and "relumine_prt" not in copy
    assert np.allclose(colors(floor), 0.5, atol=0.02)
    assert precompute(copy) == {"FINISHED"} and copy["relumine_prt"] == "//floor_001.prt"
    assert "stale: what is around" in states()["floor"] and copy.name not in states()
    # A linked duplicate cannot have light of its own; the button cures it.
    select(floor)
    bpy.ops.object.duplicate(linked=True)
    linked = bpy.context.object
    linked.location.y = 5.0
    update()
    assert "Make meshes single-user" in refusal(lambda: precompute(linked))
    select(linked)
    assert bpy.ops.relumine.single_user() == {"FINISHED"}
    assert linked.data != floor.data and precompute(linked) == {"FINISHED"}
    floor.name = "renamed"
    assert "renamed" not in {name for name, each in states().items() if "copy" in each}


def test_edit_mode_loses_nothing():
    scene = clear()
    floor, other = plane("floor"), plane("other", location=(9, 0, 0))
    precompute(floor)
    precompute(other)
    select(floor)
    bpy.ops.object.mode_set(mode="EDIT")
    shine(scene.world, (0.5, 0.25, 0.125))
    update()
    assert scene.relumine.error == "" and np.allclose(colors(other)[:, 1], 0.25, atol=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")
    update()
    assert np.allclose(colors(floor)[:, 1], 0.25, atol=0.01)


def lamp(kind, power, location=(0.0, 0.0, 2.0), rotation=(0.0, 0.0, 0.0), **values):
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = power, (1.0, 0.5, 0.25)
    for name, value in values.items():
        setattr(data, name, value)
    thing = bpy.data.objects.new(kind, data)
    thing.location, thing.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(thing)
    update()
    return thing


def drawn(size=33, scale=2.0, samples=256):
    """The scene from above, by Cycles: [size, size, 3], +Y first."""
    scene, render = bpy.context.scene, bpy.context.scene.render
    render.engine, scene.cycles.samples = "CYCLES", samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.cycles.max_bounces = "BOX", 0
    render.resolution_x = render.resolution_y = size
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = os.path.join(folder, "drawn.exr")
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", scale, (0, 0, 20)
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    pixels = np.empty(size * size * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    for each in (camera, image):
        (bpy.data.objects if each == camera else bpy.data.images).remove(each)
    return pixels.reshape(size, size, 4)[:, :, :3]


def white(thing):
    material = bpy.data.materials.new("white")
    material.use_nodes = True
    surface = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    surface.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = material.node_tree.nodes["Material Output"]
    material.node_tree.links.new(surface.outputs[0], output.inputs["Surface"])
    thing.data.materials.append(material)


def test_lamps_light_as_cycles_does():
    for kind, power, values in (
        ("SUN", 3.0, {"angle": 0.0, "rotation": (0.4, 0.3, 0.0)}),
        ("SUN", 3.0, {"angle": 0.3, "rotation": (0.4, 0.3, 0.0)}),
        ("POINT", 100.0, {"shadow_soft_size": 0.0}),
        ("SPOT", 200.0, {"spot_size": 1.0, "spot_blend": 0.6, "shadow_soft_size": 0.0,
                         "rotation": (0.1, 0.2, 0.0)}),
        ("AREA", 80.0, {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.4,
                        "rotation": (0.3, -0.2, 0.4)}),
        ("AREA", 80.0, {"shape": "DISK", "size": 0.7}),
    ):  # fmt: skip
        clear((0.0, 0.0, 0.0))
        floor = plane("floor", cuts=32)  # 33 x 33 vertices
        white(floor)
        precompute(floor)
        lamp(kind, power, **values)
        ours = colors(floor)
        truth = drawn(size=33, scale=2.0 * 33 / 32)  # pixels around the vertices
        places = np.array([vertex.co[:2] for vertex in floor.data.vertices])
        x, y = np.round((places + 1.0) * 16).astype(int).T
        inside = (x > 0) & (x < 32) & (y > 0) & (y < 32)
        of_cycles = truth[y, x][inside]
        error = np.linalg.norm(ours[inside] - of_cycles) / np.linalg.norm(of_cycles)
        print(f"{kind} {values}: {100 * error:.2f} % from Cycles")
        assert error < 0.02 and not assets.remarks, (kind, error, assets.remarks)


def test_lamps_cast_shadows():
    clear((0.0, 0.0, 0.0))
    floor = plane("floor", cuts=21)
    plane("roof", size=0.5, location=(0, 0, 1.0))
    precompute(floor)
    lamp("POINT", 100.0, shadow_soft_size=0.0)
    distance = np.array([max(map(abs, vertex.co[:2])) for vertex in floor.data.vertices])
    assert colors(floor)[distance < 0.45].max() == 0.0 < colors(floor)[distance > 0.55].min()
    bpy.data.objects["POINT"].data.use_nodes = True
    bpy.data.objects["POINT"].data.node_tree.nodes["Emission"].inputs[1].default_value = 2.0
    update()
    assert assets.remarks == ["POINT: nodes of lamps are not followed"]


def test_materials_show_light_times_color():
    scene = clear((0.5, 0.5, 0.5))
    floor = plane("floor")
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    paint = material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    paint.default_value = (0.8, 0.4, 0.2, 1.0)
    floor.data.materials.append(material)
    precompute(floor)
    select(floor)
    assert bpy.ops.relumine.material() == {"FINISHED"}
    assert floor.active_material != material
    shine(scene.world, (0.0, 0.0, 1.0))
    update()
    assert np.allclose(drawn(samples=1)[10:20, 10:20], [0.0, 0.0, 0.2], atol=0.005)
    bpy.ops.relumine.material(hide=True)
    assert floor.active_material == material


def test_lightmaps():
    scene = clear((0.5, 0.25, 1.0))
    floor = plane("floor", cuts=3)
    roof = plane("roof", size=0.5, location=(0.7, 0.7, 0.2))
    scene.relumine.receivers, scene.relumine.lightmap_size = "TEXELS", "64"
    assert "one object" in refusal(lambda: precompute(floor, roof))
    precompute(floor)
    select(floor)
    bpy.ops.relumine.material()
    shine(scene.world, (0.25, 0.25, 1.0))
    update()
    image = floor["relumine_lightmap"]
    pixels = np.array(image.pixels[:]).reshape(64, 64, 4)
    # v runs upwards: the roof shades the corner of +X and +Y.
    assert np.allclose(pixels[5:20, 5:20, :3], [0.25, 0.25, 1.0], atol=0.02)
    assert pixels[54, 54, 2] < 0.5
    assert states() == {}
    for factor, expected in ((0.5, {"floor": "stale: mesh, UV map or modifiers changed"}), (2.0, {})):
        for corner in floor.data.uv_layers.active.data:
            corner.uv *= factor
        floor.data.update()
        assert states() == expected
    roof.hide_render = True  # it would hide the floor from the camera
    picture = drawn(size=64, samples=4)
    light = 0.8 * pixels[:, :, :3]  # of new materials
    assert np.linalg.norm(picture - light) < 0.02 * np.linalg.norm(picture)


def test_lightmaps_keep_flat_faces_flat():
    scene = clear((0.0, 0.0, 0.0))
    bpy.ops.mesh.primitive_cube_add(rotation=(0.3, 0.0, 0.0), scale=(1.0, 2.0, 0.5))
    cube = bpy.context.object
    cube.name = "flat"
    scene.relumine.receivers, scene.relumine.lightmap_size = "TEXELS", "64"
    precompute(cube)
    lamp("SUN", 3.0, rotation=(0.3, 0.0, 0.0), angle=0.0)
    pixels = np.array(cube["relumine_lightmap"].pixels[:]).reshape(64, 64, 4)[:, :, 0]
    for face in cube.data.polygons:
        u, v = np.mean([cube.data.uv_layers.active.data[corner].uv for corner in face.loop_indices],
                       axis=0) * 64  # fmt: skip
        middle = pixels[int(v) - 5 : int(v) + 6, int(u) - 5 : int(u) + 6]
        assert np.allclose(middle, 3.0 / np.pi * (face.normal.z > 0.5), atol=0.02), face.normal


def test_lightmaps_say_what_is_wrong_with_uvs():
    scene = clear()
    floor = plane("floor", cuts=3)
    scene.relumine.receivers, scene.relumine.lightmap_size = "TEXELS", "64"
    assert "Warning" not in reports(lambda: precompute(floor)) and not assets.notes_of(floor)
    uvs = floor.data.uv_layers.active.data
    for corner in floor.data.polygons[0].loop_indices:
        uvs[corner].uv = uvs[floor.data.polygons[4].loop_indices[corner % 4]].uv
    for corner in floor.data.polygons[2].loop_indices:
        uvs[corner].uv.x += 1.0
    said = reports(lambda: precompute(floor))
    for text in ("texels lie in several triangles", "2 triangles have uvs outside of 0 to 1"):
        assert "Warning: " in said and text in said, said
        assert any(text in note for note in assets.notes_of(floor)), assets.notes_of(floor)


def test_coarse_meshes_are_named():
    scene = clear()
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.name = "cube"
    said = reports(lambda: precompute(cube))
    notes = ["cube: coarse: subdivide it, or use Lightmap",
             "cube: faces are flat, but light is smooth over their vertices: shade smooth, split "
             "the sharp edges, or use Lightmap"]  # fmt: skip
    assert all(f"Warning: {note}" in said for note in notes), said
    assert sorted(assets.notes_of(cube)) == notes
    bpy.ops.object.shade_smooth()
    precompute(cube)
    assert assets.notes_of(cube) == ["cube: coarse: subdivide it, or use Lightmap"]
    # A modifier's vertices do not hold light; the object's own do.
    cube.modifiers.new("fine", "SUBSURF").levels = 5
    precompute(cube)
    assert len(assets.notes_of(cube)) == 1
    bpy.ops.object.modifier_apply(modifier="fine")
    assert "Warning" not in reports(lambda: precompute(cube)) and not assets.notes_of(cube)
    scene.relumine.receivers, scene.relumine.lightmap_size = "TEXELS", "64"
    low, other = plane("low", cuts=1), plane("other", cuts=1, location=(0, 0, 3))
    precompute(low)
    assert not assets.notes_of(low)
    scene.relumine.receivers = "VERTICES"
    precompute(low, other)
    assert assets.notes_of(other)[0].startswith("low, other: coarse: subdivide them")


def test_split_faces_are_not_named():
    clear()
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.name = "cube"
    bpy.ops.object.modifier_add(type="EDGE_SPLIT")
    bpy.ops.object.modifier_apply(modifier=cube.modifiers[0].name)
    precompute(cube)
    assert assets.notes_of(cube) == ["cube: coarse: subdivide it, or use Lightmap"]


def test_hidden_blockers_stay_named():
    clear()
    floor, roof = plane("floor", cuts=50), plane("roof", location=(0, 0, 1))
    roof.hide_viewport = True
    update()
    note = "roof renders but is hidden here: it blocks no light"
    assert f"Warning: {note}" in reports(lambda: precompute(floor))
    assert assets.notes_of(floor) == [note]
    roof.hide_viewport = False
    update()
    precompute(floor)
    assert assets.notes_of(floor) == []


def test_reports():
    scene = clear()
    said = reports(bpy.ops.relumine.update)
    assert "Warning: precompute first" in said and "lit" not in said, said
    floor = plane("floor")
    # Found before the precompute, and shown until the next.
    assets.relumine.precompute, kept = None, assets.relumine.precompute
    try:
        where = os.path.join(folder, "nowhere", "floor.prt")
        text = f"{where}: cannot write: no such folder"
        assert text in refusal(lambda: precompute(floor, filepath=where))
    finally:
        assets.relumine.precompute = kept
    assert scene.relumine.error == text
    precompute(floor)
    assert scene.relumine.error == ""
    assert "Info: 1 object lit" in reports(bpy.ops.relumine.update)
    # The last failure is the one that is shown.
    scene.relumine.error = "older"
    os.rename("floor.prt", "kept.prt")
    assert "cannot read" in refusal(bpy.ops.relumine.update)
    assert "floor.prt: cannot read" in scene.relumine.error
    os.rename("kept.prt", "floor.prt")
    bpy.ops.relumine.update()
    assert scene.relumine.error == ""
    # An image that is not there.
    old, scene.world = scene.world, bpy.data.worlds.new("lost")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    image = bpy.data.images.new("sky", 4, 4)
    image.source, image.filepath = "FILE", "//lost.exr"
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs[0], tree.nodes["Background"].inputs[0])
    update()
    lost = f"Warning: image sky: cannot read {os.path.join(folder, 'lost.exr')}: no such file"
    for call in (bpy.ops.relumine.update, lambda: precompute(floor), bpy.ops.relumine.pull_lights):
        said = reports(call)
        assert lost in said, said
    scene.world = old


def test_pulled_lights_do_not_light_twice():
    scene = clear((0.5, 0.5, 0.5))
    floor = plane("floor", cuts=2)
    white(floor)
    alone = drawn(size=9).mean()
    said = reports(lambda: bpy.ops.relumine.pull_lights(number=16))
    assert "Info: 16 lights, off in renders: the world still lights; switch one of them on" in said
    collection = bpy.data.collections["Relumine lights"]
    assert collection.hide_render and len(collection.objects) == 16
    assert np.isclose(drawn(size=9).mean(), alone, rtol=0.01)
    # In place of the world.
    collection.hide_render = False
    shine(scene.world, (0.0, 0.0, 0.0))
    assert np.isclose(drawn(size=9).mean(), alone, rtol=0.1)
    bpy.data.collections.remove(collection)


def test_bounces_have_the_materials_colors():
    scene = clear()
    floor, wall = plane("floor"), plane("wall", location=(1, 0, 1), rotation=(0, np.pi / 2, 0))
    material = bpy.data.materials.new("red")
    material.use_nodes = True
    paint = material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    paint.default_value = (0.9, 0.0, 0.0, 1.0)
    wall.data.materials.append(material)
    scene.relumine.bounces = True
    precompute(floor)  # the wall is not selected; it sends light all the same
    near = colors(floor)[[vertex.co.x > 0.7 for vertex in floor.data.vertices]].mean(axis=0)
    assert near[0] > near[1] + 0.1, near
    # Its vertices see half of the sky, so the wall's red is about a fifth of the sky's light.
    assert np.isclose(near[1], near[2], atol=1e-4) and near[0] < 1.1


def test_animations_render_in_the_light_of_each_frame():
    scene = clear()
    floor = plane("floor")
    precompute(floor)
    select(floor)
    bpy.ops.relumine.material()
    for frame, value in ((1, 0.25), (2, 0.75)):
        shine(scene.world, (value, value, value))
        if bpy.app.version < (5, 0, 0):
            scene.world.keyframe_insert("color", frame=frame)
        else:
            color = scene.world.node_tree.nodes["Background"].inputs["Color"]
            color.keyframe_insert("default_value", frame=frame)
    scene.frame_start, scene.frame_end = 1, 2
    drawn(samples=1)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.location = "ORTHO", (0, 0, 20)
    camera.data.ortho_scale = 1.0
    scene.collection.objects.link(camera)
    scene.camera, scene.render.filepath = camera, os.path.join(folder, "frame_")
    bpy.ops.render.render(animation=True)
    for frame, value in ((1, 0.25), (2, 0.75)):
        image = bpy.data.images.load(os.path.join(folder, f"frame_{frame:04d}.exr"))
        mean = np.array(image.pixels[:]).reshape(-1, 4)[:, :3].mean()
        assert np.isclose(mean, 0.8 * value, atol=0.01), (frame, mean)
    for animated in (scene.world, scene.world.node_tree):
        if animated is not None:
            animated.animation_data_clear()


def main():
    os.chdir(folder)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "assets.blend"))
    wanted = os.environ.get("RELUMINE_BLENDER_CASES", "")
    wrong = []
    for name, case in list(globals().items()):
        if name.startswith("test_") and wanted in name:
            try:
                case()
                print(f"{name}: well", flush=True)
            except Exception:
                traceback.print_exc(file=sys.stdout)
                wrong.append(name)
    assert not wrong, wrong
    relumine_lights.unregister()
    print("all is well")


try:
    main()
except Exception:
    traceback.print_exc()
    sys.stdout.flush()
    os._exit(1)
