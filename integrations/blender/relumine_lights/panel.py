"""The panel and its settings."""

import textwrap

import bpy

from . import assets
from .assets import PATH
from .bake import baker


class RelumineScene(bpy.types.PropertyGroup):
    live: bpy.props.BoolProperty(
        name="Live", description="Relight when the world or a lamp changes", default=True
    )
    face_resolution: bpy.props.IntProperty(
        name="World resolution", description="Texels along a face of the world's cube map",
        default=64, min=8, max=2048,
    )  # fmt: skip
    tolerance: bpy.props.FloatProperty(
        name="Tolerance", description="Error of the light that is allowed; smaller is finer",
        default=0.0135, min=0.001, max=1.0, precision=4,
    )  # fmt: skip
    bounces: bpy.props.BoolProperty(
        name="Bounces", description="Surfaces send light on, in the base colours of their materials"
    )
    receivers: bpy.props.EnumProperty(
        name="Light", items=(("VERTICES", "Vertices", "A colour attribute"),
                             ("TEXELS", "Lightmap", "An image on the active UV map")),
    )  # fmt: skip
    lightmap_size: bpy.props.EnumProperty(
        name="Size", default="512",
        items=[(str(2**n), f"{2**n} x {2**n}", "Texels") for n in range(6, 13)],
    )  # fmt: skip
    error: bpy.props.StringProperty()


class RelumineObject(bpy.types.PropertyGroup):
    file: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", options={"ANIMATABLE", *assets.RELATIVE},
        description="Where the precompute goes; empty: beside the .blend, named after the object",
    )  # fmt: skip


class RELUMINE_PT_panel(bpy.types.Panel):
    bl_label = "Relumine"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Relumine"

    def draw(self, context):
        layout, settings, thing = self.layout, context.scene.relumine, context.object
        if thing is not None and thing.type == "MESH":
            layout.prop(thing.relumine, "file")
        for name in ("tolerance", "bounces", "receivers"):
            layout.prop(settings, name)
        if settings.receivers == "TEXELS":
            layout.prop(settings, "lightmap_size")
        layout.operator("relumine.precompute")
        self._states(context)
        row = layout.row(align=True)
        row.operator("relumine.material")
        row.operator("relumine.material", text="Own materials").hide = True
        layout.separator()
        layout.prop(settings, "live")
        layout.prop(settings, "face_resolution")
        layout.operator("relumine.update")
        if baker.is_busy:
            layout.label(text="The world is being baked", icon="TIME")
        for line in assets.remarks:
            said(layout, context, line, "INFO")
        if settings.error:
            said(layout, context, settings.error, "ERROR")
        layout.separator()
        layout.operator("relumine.pull_lights")
        row = layout.operator("relumine.pull_lights", text="Pull lights for this asset")
        row.for_object = True

    def _states(self, context):
        """The badges: what of the scene's objects is no longer right, and its cure."""
        layout, thing = self.layout, context.object
        if thing is not None and PATH in thing:
            layout.label(text=thing[PATH], icon="FILE")
            for note in assets.notes_of(thing):
                said(layout, context, note, "INFO")
            if assets.followed(thing):
                said(layout, context, assets.followed(thing), "CHECKMARK")
        for following in assets.followings():
            said(layout, context, str(following), "TIME")
        for name, state in sorted(assets.states.items()):
            said(layout, context, f"{name} {state}", "ERROR")
        state = assets.states.get(thing.name, "") if thing is not None else ""
        if state.startswith("stale"):
            layout.operator("relumine.precompute", text="Precompute again").again = True
        elif "shares" in state or any(each.type == "MESH" and each.data.users > 1
                                      for each in context.selected_objects):  # fmt: skip
            layout.operator("relumine.single_user")
        if thing is not None and thing.mode == "EDIT" and PATH in thing:
            said(layout, context, "In Edit Mode: its light follows when you leave", "INFO")


def said(layout, context, text, icon):
    """A text as wide as the panel, in several lines where it is long."""
    scale = context.preferences.system.ui_scale
    width = max(20, int(context.region.width / (8.0 * scale)) - 5)
    column = layout.column(align=True)
    for line in textwrap.wrap(text, width):
        column.label(text=line, icon=icon)
        icon = "BLANK1"


CLASSES = (RelumineScene, RelumineObject, RELUMINE_PT_panel)
