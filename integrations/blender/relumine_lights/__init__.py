"""Relumine in Blender: the world and the lamps light objects as they change.

*Precompute transfer* finds once how much light reaches every vertex of the selected objects. From
then on the world and the lamps drive the colour attribute "Relumine" of each object, or its
lightmap, with all shadows, in milliseconds.

Axes: Blender's (x, y, z) is Relumine's (x, z, -y). Units: Cycles' own; the attribute is outgoing
radiance for albedo 1.

assets.py      objects and their scene files: what the rest is for
following.py   light that follows objects
worlds.py      what the world's nodes say; bake.py and bake_worker.py render those that say more
lamps.py       suns, and lamps near the scene
geometry.py    meshes, what stands around them, keys
materials.py   base colours, materials that show the light, attributes and lightmaps
operators.py, panel.py
"""

import bpy
from bpy.app.handlers import persistent

try:
    import relumine  # noqa: F401
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "Relumine's Python package is not found: install python3-relumine, or name its folder in "
        "PYTHONPATH, and start Blender with --python-use-system-env (docs/blender.md)"
    ) from error

from . import assets, operators, panel
from .bake import baker
from .geometry import shape_changed

bl_info = {
    "name": "Relumine",
    "description": "Lights objects with the world and lamps, shadows included, while they change",
    "author": "Relumine developers",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Relumine",
    "category": "Lighting",
}

LIGHT_TYPES = (bpy.types.World, bpy.types.Light, bpy.types.ShaderNodeTree, bpy.types.Image,
               bpy.types.Scene)  # fmt: skip
#: Seconds of rest after which changes of meshes are looked for.
REST = 0.3


def is_light(update):
    return isinstance(update.id, LIGHT_TYPES) or (
        isinstance(update.id, bpy.types.Object) and update.id.type != "MESH"
    )


@persistent
def on_change(scene, depsgraph=None):
    if assets.is_at_work():
        return
    updates = list(depsgraph.updates) if depsgraph is not None else []
    for update in updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            shape_changed(update.id.name_full)
    if any(isinstance(update.id, (bpy.types.Object, bpy.types.Collection)) for update in updates):
        _later(_look, REST)
    if depsgraph is None or assets.is_waiting(scene) or any(map(is_light, updates)):
        _relight(scene, depsgraph)
        if baker.is_busy:
            _later(_take_bake, 0.05)


@persistent
def on_frame(scene, depsgraph=None):
    """A picture that renders must be right: bakes are waited for."""
    _relight(scene, depsgraph, wait=bpy.app.background or _renders)


_renders = False
_said = set()  # lines that a render has printed


@persistent
def on_render(scene, depsgraph=None):
    """Says what is no longer right; a render in the background has no panel."""
    global _renders
    _renders = True
    lines = [f"{name} {state}" for name, state in assets.look_for_changes(scene).items()]
    for line in filter(None, (*lines, *assets.remarks, scene.relumine.error)):
        if line not in _said:
            print(f"Relumine: {line}")
            _said.add(line)


@persistent
def on_render_end(scene, depsgraph=None):
    global _renders
    _renders = False


def _later(call, seconds):
    """Calls once, when the user rests; in the background nobody looks."""
    if bpy.app.background:
        return
    if bpy.app.timers.is_registered(call):
        if call is not _look:
            return
        bpy.app.timers.unregister(call)
    bpy.app.timers.register(call, first_interval=seconds)


def _relight(scene, depsgraph=None, **how):
    assets.relight_quietly(scene, depsgraph, **how)
    if assets.followings():
        _later(_take_moves, 0.1)


def _look():
    _relight(bpy.context.scene)  # what has moved
    assets.untie_copies(bpy.context.scene)
    assets.look_for_changes(bpy.context.scene)
    _redraw()


def _take_bake():
    if baker.is_busy:
        try:
            baker.take(None)
        except RuntimeError as error:
            bpy.context.scene.relumine.error = str(error)
    if baker.is_busy:
        return 0.05
    _relight(bpy.context.scene)
    _redraw()
    return 0.05 if baker.is_busy else None


def _take_moves():
    """Tells how far the light has followed, and takes it once it is there."""
    on_their_way = assets.followings()
    text = "; ".join(f"Relumine: {each}" for each in on_their_way)
    if not any(each.is_busy for each in on_their_way):
        assets.relight_quietly(bpy.context.scene)
        assets.look_for_changes(bpy.context.scene)
        text = None
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(text)
    _redraw()
    return 0.1 if assets.followings() else None


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()


@persistent
def on_undo(scene, depsgraph=None):
    """Undo brings back an older attribute: it is written again."""
    shape_changed()
    _relight(bpy.context.scene, force=True)
    _later(_look, REST)


@persistent
def on_load(path):
    assets.forget_all()
    on_undo(None)


_CLASSES = (*panel.CLASSES, *operators.CLASSES)
_HANDLERS = (
    ("depsgraph_update_post", on_change),
    ("frame_change_post", on_frame),
    ("undo_post", on_undo),
    ("redo_post", on_undo),
    ("load_post", on_load),
    ("render_init", on_render),
    ("render_complete", on_render_end),
    ("render_cancel", on_render_end),
)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.relumine = bpy.props.PointerProperty(type=panel.RelumineScene)
    bpy.types.Object.relumine = bpy.props.PointerProperty(type=panel.RelumineObject)
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    for call in (_look, _take_bake, _take_moves):
        if bpy.app.timers.is_registered(call):
            bpy.app.timers.unregister(call)
    del bpy.types.Scene.relumine, bpy.types.Object.relumine
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    assets.forget_all()
    baker.close()
