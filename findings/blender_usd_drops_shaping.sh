#!/usr/bin/env bash
# bpy (USD importer): profiles of lamps and cones of disks are dropped.
#
# Expected: a SphereLight with `shaping:ies:file` gets Blender's IES Texture node, or a message. A DiskLight with a cone of 30
#           degrees gets an area light with a spread of 60, as a SphereLight with a cone becomes a spot of 60.
# Found:    the sphere becomes a plain point and the disk a plain disk. A lamp that shines down lights the ceiling as well, and
#           nothing is said.
# Tried:    bpy 4.5.3 of PyPI, Python 3.11. So does bpy 5.2.3.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==4.5.3
cat >shaping.py <<'PYTHON'
import math
import os

import bpy

with open("down.ies", "w") as file:
    file.write("IESNA:LM-63-2002\n[TEST] -\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n1000 500 0\n")


def imported(kind, shaping=""):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with open("lamp.usda", "w") as file:
        file.write(f"""#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def {kind} "L" (
    prepend apiSchemas = ["ShapingAPI"]
)
{{
    float inputs:radius = 0.1
    float inputs:intensity = 10
    {shaping}
}}
""")
    bpy.ops.wm.usd_import(filepath=os.path.abspath("lamp.usda"))
    (lamp,) = bpy.data.lights
    nodes = [node.bl_idname for node in lamp.node_tree.nodes] if lamp.node_tree else []
    return {"type": lamp.type, "energy": round(lamp.energy, 4), "nodes": nodes,
            "spread": round(math.degrees(getattr(lamp, "spread", 0))), "cone": round(math.degrees(getattr(lamp, "spot_size", 0)))}


profile = "asset inputs:shaping:ies:file = @down.ies@"
cone = "float inputs:shaping:cone:angle = 30"
print("found: a ball with a cone:", imported("SphereLight", cone))
assert imported("SphereLight", cone)["cone"] == 60
plain, shaped = imported("SphereLight"), imported("SphereLight", profile)
print("found: a ball:", plain, "- with a profile:", shaped)
assert plain == shaped and not any("TexIES" in node for node in shaped["nodes"])
plain, shaped = imported("DiskLight"), imported("DiskLight", cone)
print("found: a disk:", plain, "- with a cone:", shaped)
assert plain == shaped and shaped["spread"] == 180
print("held")
PYTHON
venv/bin/python shaping.py 2>log | grep -E "found|held" || { tail -5 log; exit 1; }
