"""What the buttons do."""

import threading

import bpy

import relumine

from . import assets, geometry, lamps, materials
from .assets import BOUNCES, PATH, TEXELS, TOLERANCE
from .worlds import WorldLight

ERRORS = (OSError, ValueError, RuntimeError, MemoryError)


def meshes(context):
    return [thing for thing in context.selected_objects if thing.type == "MESH"]


def counted(number, word):
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


class Button(bpy.types.Operator):
    """An operator whose act() may raise what the user should read. It returns what was done, and
    adds to `doubts`."""

    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        self.doubts = []
        try:
            done = self.act(context)
        except ERRORS as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if done:
            self.report({"INFO"}, done)
        for line in self.doubts:
            self.report({"WARNING"}, line)
        return {"FINISHED"}


class RELUMINE_OT_precompute(bpy.types.Operator):
    """Find how much light reaches every vertex of the selected objects"""

    bl_idname = "relumine.precompute"
    bl_label = "Precompute transfer"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(
        subtype="FILE_PATH", options={"ANIMATABLE", *assets.RELATIVE},
        description="Empty: the file of the panel, or one named after the object",
    )
    again: bpy.props.BoolProperty(
        description="All objects of the active one's asset, as it was made", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context):
        cls.poll_message_set("expected Object Mode and an active object: select a mesh")
        return context.mode == "OBJECT" and context.object is not None

    def _begin(self, context):
        settings, thing = context.scene.relumine, context.object
        texels = int(settings.lightmap_size) if settings.receivers == "TEXELS" else 0
        options = {"tolerance": settings.tolerance, "bounces": settings.bounces, "texels": texels}
        things, path = meshes(context), self.filepath
        assets.untie_copies(context.scene)
        if self.again:
            if PATH not in thing:
                raise ValueError(f"{thing.name}: expected an object with a precomputed transfer")
            things, path = assets.partners(context.scene, thing), thing[PATH]
            options = {"tolerance": thing[TOLERANCE], "bounces": bool(thing[BOUNCES]),
                       "texels": thing[TEXELS]}  # fmt: skip
        if not things:
            raise ValueError("expected a selected mesh, got none")
        path = path or assets.default_path(context)
        if path.startswith("//") and not bpy.data.filepath:
            raise ValueError("save the .blend first, or choose where the scene file goes")
        return assets.Precompute(context, things, path, **options)

    def _end(self):
        self._made.tie()
        for note in (*sorted(self._made.notes), *missing_images(self._made.scene)):
            self.report({"WARNING"}, note)
        return {"FINISHED"}

    def _fail(self, context, error):
        context.scene.relumine.error = str(error)
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def execute(self, context):
        try:
            self._made = self._begin(context)
            self._made.work()
        except ERRORS as error:
            return self._fail(context, error)
        return self._end()

    def invoke(self, context, event):
        self._fraction, self._error, self._cancel = 0.0, None, False
        try:
            self._made = self._begin(context)
        except ERRORS as error:
            return self._fail(context, error)

        def progress(fraction):
            self._fraction = fraction
            if self._cancel:
                raise RuntimeError("cancelled")

        def run():
            try:
                self._made.work(progress)
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
            return self._end()
        if not self._cancel:
            return self._fail(context, self._error)
        self.report({"INFO"}, str(self._error))
        return {"CANCELLED"}


class RELUMINE_OT_single_user(Button):
    """Give each selected object a mesh of its own, which can hold its own light"""

    bl_idname = "relumine.single_user"
    bl_label = "Make meshes single-user"

    def act(self, context):
        shared = [thing for thing in meshes(context) if geometry.is_shared(thing)]
        for thing in shared:
            if geometry.is_shared(thing):
                thing.data = thing.data.copy()
        assets.look_for_changes(context.scene)
        return f"{counted(len(shared), 'object')} made single-user"


class RELUMINE_OT_material(Button):
    """Show the light times the base colour on the selected objects, in materials of their own"""

    bl_idname = "relumine.material"
    bl_label = "Show light"

    hide: bpy.props.BoolProperty(name="Own materials back")

    def act(self, context):
        things = meshes(context)
        if not things:
            raise ValueError("expected a selected mesh, got none")
        for thing in things:
            (materials.hide_light if self.hide else materials.show_light)(thing)


class RELUMINE_OT_update(Button):
    """Bake the world anew, read the scene files again and write the light"""

    bl_idname = "relumine.update"
    bl_label = "Update light"

    def act(self, context):
        assets.forget_all()
        assets.untie_copies(context.scene)
        settings = context.scene.relumine
        settings.error = ""
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            count = assets.relight(
                context.scene, force=True, wait=True,
                progress=lambda fraction: manager.progress_update(100 * fraction),
            )  # fmt: skip
        except ERRORS as error:
            settings.error = str(error)
            raise
        finally:
            manager.progress_end()
            assets.look_for_changes(context.scene)
        if not assets.lit_objects(context.scene):
            self.doubts.append("precompute first: no object has a transfer")
            return None
        self.doubts += missing_images(context.scene)
        self.doubts += [f"{name}: {state}" for name, state in sorted(assets.states.items())]
        return f"{counted(count, 'object')} lit"


class RELUMINE_OT_pull_lights(Button):
    """Make sun lights that stand for the world"""

    bl_idname = "relumine.pull_lights"
    bl_label = "Pull lights"

    number: bpy.props.IntProperty(name="Lights", default=64, min=1, max=4096)
    for_object: bpy.props.BoolProperty(
        name="For this asset", description="Choose lights for the active object: about a minute"
    )

    def act(self, context):
        thing = context.object if self.for_object else None
        if thing is not None and PATH not in thing:
            raise ValueError(f"{thing.name}: expected an object with a precomputed transfer")
        number = pull_lights(context.scene, self.number, thing=thing)
        self.doubts += missing_images(context.scene)
        return (f"{counted(number, 'light')}, off in renders: the world still lights; "
                "switch one of them on")  # fmt: skip


def missing_images(scene):
    """What is to be said of images of the world that are not there; Blender's light is magenta."""
    return WorldLight(scene, bpy.context.evaluated_depsgraph_get()).missing


def pull_lights(scene, number, *, thing=None):
    """Makes suns of the world by median cut or, with an object, for its scene file. They do not
    render: the world would light twice."""
    world = WorldLight(scene, bpy.context.evaluated_depsgraph_get())
    environment = world.environment(scene.relumine.face_resolution, wait=True)
    if thing is None:
        lights = environment.median_cut(number)
    else:
        relighter = relumine.Relighter(relumine.Scene.load(assets.path_of(thing)))
        relighter.set_environment(environment)
        lights = relighter.transfer_lights(number)
    collection = bpy.data.collections.get("Relumine lights")
    if collection is None:
        collection = bpy.data.collections.new("Relumine lights")
        scene.collection.children.link(collection)
    collection.hide_render = True
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
        sun.rotation_quaternion = lamps.towards((x, -z, y))
        sun[lamps.PULLED] = True
        collection.objects.link(sun)
    return len(lights)


CLASSES = (RELUMINE_OT_precompute, RELUMINE_OT_single_user, RELUMINE_OT_material,
           RELUMINE_OT_update, RELUMINE_OT_pull_lights)  # fmt: skip
