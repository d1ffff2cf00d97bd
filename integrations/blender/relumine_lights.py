"""Relumine in Blender: the world and the suns light objects as they change.

*Precompute transfer* finds once how much light reaches every vertex of the selected objects. From
then on the world's environment texture, its rotation and strength, and the sun lights drive the
colour attribute "Relumine" of each object, with all shadows, in milliseconds.

Axes: Blender's (x, y, z) is Relumine's (x, z, -y). Units: a sun's strength is irradiance, as in
Cycles; the attribute is outgoing radiance for albedo 1.
"""

import os
import threading

import bpy
import numpy as np
from bpy.app.handlers import persistent
from mathutils import Vector, kdtree

import relumine

bl_info = {
    "name": "Relumine",
    "description": "Lights objects with the world and suns, shadows included, while they change",
    "author": "Relumine developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Relumine",
    "category": "Lighting",
}

ATTRIBUTE = "Relumine"
#: Keys of objects: the scene file, and the vertices in it that are this object's.
PATH, FIRST, COUNT = "relumine_prt", "relumine_first", "relumine_count"
#: Suns that stand for the world do not light on top of it.
PULLED = "relumine_pulled"


# Geometry


def to_relumine(points):
    """(N, 3) from Blender's axes to Relumine's."""
    return np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def evaluated_arrays(thing, depsgraph):
    """World vertices (N, 3) and triangles (M, 3) of an object with its modifiers."""
    evaluated = thing.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", vertices)
        mesh.calc_loop_triangles()
        triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
    finally:
        evaluated.to_mesh_clear()
    matrix = np.array(thing.matrix_world, dtype=np.float64)
    world = vertices.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    triangles = triangles.reshape(-1, 3)
    if np.linalg.det(matrix[:3, :3]) < 0:
        triangles = triangles[:, ::-1]  # mirrored: keep the outside outside
    return world, triangles


def nearest_vertices(thing, depsgraph):
    """For each vertex of an object's own mesh, the vertex of its evaluated mesh that it became.

    Most modifiers keep the number of vertices; then they are the same. Others (subdivision, mirror,
    array) are asked for the nearest vertex; Blender spreads the colours over the rest.
    """
    evaluated = thing.evaluated_get(depsgraph).data
    own = thing.data.vertices
    if len(own) == len(evaluated.vertices):
        return np.arange(len(own))
    tree = kdtree.KDTree(len(evaluated.vertices))
    for index, vertex in enumerate(evaluated.vertices):
        tree.insert(vertex.co, index)
    tree.balance()
    return np.array([tree.find(vertex.co)[1] for vertex in own])


# Light


class WorldLight:
    """What the world's nodes say: an image or a colour, a rotation, a strength."""

    def __init__(self, world):
        self.path, self.color, self.strength, self.rotate = None, (0.0, 0.0, 0.0), 1.0, 0.0
        if world is None:
            return
        if not world.use_nodes:
            self.color = tuple(world.color)
            return
        background = self._background(world.node_tree)
        if background is None:
            return
        self.strength = background.inputs["Strength"].default_value
        self.color = tuple(background.inputs["Color"].default_value)[:3]
        texture = self._before(background.inputs["Color"], "TEX_ENVIRONMENT")
        if texture is None or texture.image is None:
            return
        self.path = os.path.normpath(bpy.path.abspath(texture.image.filepath))
        mapping = self._before(texture.inputs["Vector"], "MAPPING")
        if mapping is not None:
            x, y, z = mapping.inputs["Rotation"].default_value
            if abs(x) > 1e-6 or abs(y) > 1e-6:
                raise ValueError("the world's mapping turns about X or Y; only Z is followed")
            # As a point, the mapping turns what is looked up; the picture turns the other way.
            self.rotate = float(np.degrees(z if mapping.vector_type == "TEXTURE" else -z))

    @staticmethod
    def _background(tree):
        output = next((n for n in tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output),
                      None)  # fmt: skip
        return None if output is None else WorldLight._before(output.inputs["Surface"],
                                                              "BACKGROUND")  # fmt: skip

    @staticmethod
    def _before(socket, kind):
        node = socket.links[0].from_node if socket.is_linked else None
        return node if node is not None and node.type == kind else None

    def key(self):
        """What changes with the light's shape, not with its strength."""
        stamp = os.path.getmtime(self.path) if self.path and os.path.exists(self.path) else 0
        return (self.path, stamp, round(self.rotate, 6), None if self.path else self.color)


def sun_arrays(scene):
    """Directions and irradiances of the visible suns."""
    directions, irradiances = [], []
    for thing in scene.objects:
        if thing.type != "LIGHT" or thing.data.type != "SUN" or thing.get(PULLED):
            continue
        if thing.hide_get() or thing.hide_viewport or thing.data.energy <= 0:
            continue
        direction = thing.matrix_world.to_3x3() @ Vector((0, 0, 1))
        directions.append(tuple(direction.normalized()))
        irradiances.append([thing.data.energy * c for c in thing.data.color])
    return np.array(directions).reshape(-1, 3), np.array(irradiances).reshape(-1, 3)


class LiveScene:
    """A scene file in the light of the world and of the suns."""

    def __init__(self, path):
        self.stamp = os.path.getmtime(path)
        self.scene = relumine.Scene.load(path)
        self.world = relumine.Relighter(self.scene)
        self.suns = relumine.Relighter(self.scene)
        self.world_key = self.suns_key = self.written_key = None
        self.under_suns = 0.0
        self.radiance = np.zeros((self.scene.num_receivers, 3), dtype=np.float32)

    def light(self, scene):
        """Returns whether the radiance changed."""
        world = WorldLight(scene.world)
        key = (*world.key(), scene.relumine_face_resolution)
        directions, irradiances = sun_arrays(scene)
        suns_key = (directions.tobytes(), irradiances.tobytes())
        if (key, world.strength, suns_key) == self.written_key:
            return False
        if key != self.world_key:
            self.world.set_environment(environment_of(world, scene.relumine_face_resolution))
            self.world_key = key
        if suns_key != self.suns_key:
            self.under_suns = 0.0
            if len(directions):
                self.suns.set_lights(relumine.LightList(to_relumine(directions), irradiances))
                self.under_suns = self.suns.radiance
            self.suns_key = suns_key
        strength = world.strength
        np.add(self.world.radiance * np.float32(strength), self.under_suns, out=self.radiance)
        self.written_key = (key, world.strength, suns_key)
        return True


_live = {}  # path: LiveScene
_environments = {}  # (path, time, resolution): Environment
_nearest = {}  # (object, numbers of vertices): nearest_vertices()
_at_work = False


def environment_of(world, face_resolution):
    """The world's picture; turns of it are made from the one in memory."""
    if world.path is None:
        return relumine.Environment(np.full((6, 8, 8, 3), world.color))
    key = (world.path, os.path.getmtime(world.path), face_resolution)
    if key not in _environments:
        _environments.clear()
        _environments[key] = relumine.Environment.load(
            world.path, convention="blender", face_resolution=face_resolution
        )
    return _environments[key].turned(rotate=world.rotate, face_resolution=face_resolution)


def write_colors(thing, radiance):
    """Puts (N, 3) into the object's colour attribute, which is made where it is missing."""
    attributes = thing.data.color_attributes
    attribute = attributes.get(ATTRIBUTE)
    if attribute is None:
        attribute = attributes.new(ATTRIBUTE, "FLOAT_COLOR", "POINT")
        attributes.active_color = attribute
    rgba = np.ones((len(radiance), 4), dtype=np.float32)
    rgba[:, :3] = radiance
    attribute.data.foreach_set("color", rgba.ravel())
    thing.data.update_tag()


def lit_objects(scene):
    return [thing for thing in scene.objects if thing.type == "MESH" and PATH in thing]


def path_of(thing):
    return os.path.normpath(bpy.path.abspath(thing[PATH]))


def missing_file(scene):
    """A scene file that objects are tied to and that is not there, or None."""
    paths = map(path_of, lit_objects(scene))
    return next((path for path in paths if not os.path.exists(path)), None)


def relight(scene, *, force=False):
    """Brings all objects of the scene up to date. Returns how many changed."""
    changed = {}
    count = 0
    depsgraph = None
    for thing in lit_objects(scene):
        path = path_of(thing)
        if not os.path.exists(path):
            continue
        live = _live.get(path)
        if live is None or live.stamp != os.path.getmtime(path):
            live = _live[path] = LiveScene(path)
        if path not in changed:
            changed[path] = live.light(scene)
        if not (changed[path] or force or ATTRIBUTE not in thing.data.color_attributes):
            continue
        if depsgraph is None:
            depsgraph = bpy.context.evaluated_depsgraph_get()
        own = live.radiance[thing[FIRST] : thing[FIRST] + thing[COUNT]]
        numbers = (thing.name, len(thing.data.vertices), thing[COUNT])
        if numbers not in _nearest:
            _nearest[numbers] = nearest_vertices(thing, depsgraph)
        nearest = _nearest[numbers]
        if len(nearest) and nearest.max() < len(own):
            write_colors(thing, own if len(nearest) == len(own) else own[nearest])
            count += 1
    return count


def relight_quietly(scene, force=False):
    """For handlers, which must not raise: an error is shown in the panel."""
    global _at_work
    if _at_work or not scene.relumine_live:
        return
    _at_work = True
    try:
        relight(scene, force=force)
        missing = missing_file(scene)
        scene["relumine_error"] = f"{missing}: cannot read: no such file" if missing else ""
    except (OSError, ValueError, RuntimeError, MemoryError) as error:
        scene["relumine_error"] = str(error)
    finally:
        _at_work = False


# Work


def precompute(context, things, path, *, tolerance, progress=None):
    """Precomputes objects together, so that they shadow each other, and ties them to the file."""
    depsgraph = context.evaluated_depsgraph_get()
    vertices, triangles, places, first = [], [], [], 0
    for thing in things:
        if thing.data.users > 1:
            raise ValueError(f"{thing.name}: expected a mesh of its own, got one that others share")
        own_vertices, own_triangles = evaluated_arrays(thing, depsgraph)
        if not len(own_triangles):
            raise ValueError(f"{thing.name}: expected a mesh with faces, got none")
        vertices.append(own_vertices)
        triangles.append(own_triangles + first)
        places.append((thing, first, len(own_vertices)))
        first += len(own_vertices)
    mesh = relumine.Mesh(to_relumine(np.concatenate(vertices)), np.concatenate(triangles))
    absolute = bpy.path.abspath(path)

    def work():
        relumine.precompute(mesh, tolerance=tolerance, output=absolute, progress=progress)

    def tie():
        for thing, begin, count in places:
            thing[PATH], thing[FIRST], thing[COUNT] = path, begin, count
        _nearest.clear()
        _live.pop(os.path.normpath(absolute), None)
        relight(context.scene, force=True)

    return work, tie


def pull_lights(scene, number, *, thing=None):
    """Makes suns of the world by median cut or, with an object, for its scene file."""
    world = WorldLight(scene.world)
    environment = environment_of(world, scene.relumine_face_resolution)
    if thing is None:
        lights = environment.median_cut(number)
    else:
        relighter = relumine.Relighter(relumine.Scene.load(bpy.path.abspath(thing[PATH])))
        relighter.set_environment(environment)
        lights = relighter.transfer_lights(number)
    collection = bpy.data.collections.get("Relumine lights")
    if collection is None:
        collection = bpy.data.collections.new("Relumine lights")
        scene.collection.children.link(collection)
    for old in list(collection.objects):
        bpy.data.objects.remove(old)
    for index, (direction, irradiance) in enumerate(zip(lights.directions, lights.irradiances)):
        energy = float(irradiance.max()) * world.strength
        lamp = bpy.data.lights.new(f"Relumine {index}", "SUN")
        lamp.energy = energy
        lamp.color = irradiance / irradiance.max() if energy > 0 else (1, 1, 1)
        lamp.angle = 0.0
        sun = bpy.data.objects.new(lamp.name, lamp)
        x, y, z = direction
        sun.rotation_mode = "QUATERNION"
        sun.rotation_quaternion = Vector((x, -z, y)).to_track_quat("Z", "Y")
        sun[PULLED] = True
        collection.objects.link(sun)
    return len(lights)


class RELUMINE_OT_precompute(bpy.types.Operator):
    """Find how much light reaches every vertex of the selected objects"""

    bl_idname = "relumine.precompute"
    bl_label = "Precompute transfer"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", default="//relumine.prt")
    tolerance: bpy.props.FloatProperty(name="Tolerance", default=0.0135, min=0.001, max=1.0)

    @classmethod
    def poll(cls, context):
        return any(thing.type == "MESH" for thing in context.selected_objects)

    def _begin(self, context, progress=None):
        things = [thing for thing in context.selected_objects if thing.type == "MESH"]
        if self.filepath.startswith("//") and not bpy.data.filepath:
            raise ValueError("save the .blend first, or choose where the scene file goes")
        return precompute(context, things, self.filepath, tolerance=self.tolerance,
                          progress=progress)  # fmt: skip

    def execute(self, context):
        try:
            work, tie = self._begin(context)
            work()
            tie()
        except (OSError, ValueError, RuntimeError, MemoryError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, event):
        self._fraction, self._error, self._cancel = 0.0, None, False

        def progress(fraction):
            self._fraction = fraction
            if self._cancel:
                raise RuntimeError("cancelled")

        try:
            work, self._tie = self._begin(context, progress)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

        def run():
            try:
                work()
            except Exception as error:  # told in modal()
                self._error = error

        self._thread = threading.Thread(target=run)
        self._thread.start()
        context.window_manager.progress_begin(0, 100)
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._cancel = True
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        manager = context.window_manager
        manager.progress_update(100 * self._fraction)
        context.workspace.status_text_set(
            f"Relumine: {100 * self._fraction:.0f} %, Esc stops the precompute"
        )
        if self._thread.is_alive():
            return {"RUNNING_MODAL"}
        manager.event_timer_remove(self._timer)
        manager.progress_end()
        context.workspace.status_text_set(None)
        if self._error is None:
            self._tie()
            return {"FINISHED"}
        self.report({"INFO" if self._cancel else "ERROR"}, str(self._error))
        return {"CANCELLED"}


class RELUMINE_OT_pull_lights(bpy.types.Operator):
    """Make sun lights that stand for the world"""

    bl_idname = "relumine.pull_lights"
    bl_label = "Pull lights"
    bl_options = {"REGISTER", "UNDO"}

    number: bpy.props.IntProperty(name="Lights", default=64, min=1, max=4096)
    for_object: bpy.props.BoolProperty(
        name="For this asset", description="Choose lights for the active object: about a minute"
    )

    def execute(self, context):
        thing = context.object if self.for_object else None
        if thing is not None and PATH not in thing:
            self.report({"ERROR"}, f"{thing.name}: expected an object with a precomputed transfer")
            return {"CANCELLED"}
        try:
            count = pull_lights(context.scene, self.number, thing=thing)
        except (OSError, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{count} lights")
        return {"FINISHED"}


class RELUMINE_PT_panel(bpy.types.Panel):
    bl_label = "Relumine"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Relumine"

    def draw(self, context):
        layout, scene = self.layout, context.scene
        layout.operator("relumine.precompute")
        layout.prop(scene, "relumine_live")
        layout.prop(scene, "relumine_face_resolution")
        layout.operator("relumine.pull_lights")
        row = layout.operator("relumine.pull_lights", text="Pull lights for this asset")
        row.for_object = True
        thing = context.object
        if thing is not None and PATH in thing:
            layout.label(text=thing[PATH], icon="FILE")
        if scene.get("relumine_error"):
            layout.label(text=scene["relumine_error"], icon="ERROR")


# Handlers


@persistent
def on_change(scene, depsgraph=None):
    if depsgraph is not None and not any(
        isinstance(update.id, (bpy.types.World, bpy.types.Light, bpy.types.ShaderNodeTree,
                               bpy.types.Image, bpy.types.Scene))
        or (isinstance(update.id, bpy.types.Object) and update.id.type == "LIGHT")
        for update in depsgraph.updates
    ):  # fmt: skip
        return
    relight_quietly(scene)


@persistent
def on_undo(scene, depsgraph=None):
    """Undo brings back an older attribute: it is written again."""
    relight_quietly(bpy.context.scene, force=True)


@persistent
def on_load(path):
    _live.clear()
    _environments.clear()
    _nearest.clear()
    relight_quietly(bpy.context.scene, force=True)


_CLASSES = (RELUMINE_OT_precompute, RELUMINE_OT_pull_lights, RELUMINE_PT_panel)
_HANDLERS = (
    ("depsgraph_update_post", on_change),
    ("frame_change_post", on_change),
    ("undo_post", on_undo),
    ("redo_post", on_undo),
    ("load_post", on_load),
)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.relumine_live = bpy.props.BoolProperty(
        name="Live", description="Relight when the world or a sun changes", default=True
    )
    bpy.types.Scene.relumine_face_resolution = bpy.props.IntProperty(
        name="World resolution", description="Texels along a face of the world's cube map",
        default=64, min=8, max=2048,
    )  # fmt: skip
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    del bpy.types.Scene.relumine_live, bpy.types.Scene.relumine_face_resolution
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    _live.clear()
    _environments.clear()
    _nearest.clear()
