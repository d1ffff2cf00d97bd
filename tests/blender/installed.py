"""Runs in `blender -b` with a clean profile: installs the add-on and lights an object as
docs/blender.md says. ARCHIVE FOLDER follow `--`."""

import os
import sys
import traceback

import bpy
import numpy as np

archive, folder = sys.argv[sys.argv.index("--") + 1 :]


def main():
    bpy.ops.preferences.addon_install(filepath=archive)
    assert bpy.ops.preferences.addon_enable(module="relumine_lights") == {"FINISHED"}
    cube = bpy.data.objects["Cube"]
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "first.blend"))
    cube.select_set(True)
    bpy.context.view_layer.objects.active = cube
    assert bpy.ops.relumine.precompute() == {"FINISHED"}
    assert os.path.exists(os.path.join(folder, "Cube.prt"))
    assert bpy.ops.relumine.material() == {"FINISHED"}
    values = np.array([each.color[:3] for each in cube.data.color_attributes["Relumine"].data])
    assert values.max() > 0.05, values  # the grey world and the default lamp
    assert bpy.ops.preferences.addon_disable(module="relumine_lights") == {"FINISHED"}


try:
    main()
    print("all is well")
except Exception:
    traceback.print_exc()
    sys.stdout.flush()
    os._exit(1)
