#!/usr/bin/env bash
# Mitsuba: `envmap` has its zenith at +Y, `sunsky` at +Z.
#
# Expected: the emitters that stand for a sky share one up, so that a scene that was lit by a panorama can be lit by a computed
#           sky: the sky is above, the ground below is dark.
# Found:    a `sunsky` in a scene whose up is +Y lies on its side: half of the horizon is in the ground and half of the walls'
#           light is missing at -Z. The upper row of an `envmap` is at +Y. `to_world` with a turn of -90 degrees about X
#           makes them agree. `sun_direction` is in the sky's own axes and turns with it.
# Tried:    mitsuba 3.9.1 of PyPI (scalar_rgb), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q mitsuba==3.9.1 numpy==2.4.6
cat >sky.py <<'PYTHON'
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
AXES = {"+X": (1, 0, 0), "-X": (-1, 0, 0), "+Y": (0, 1, 0), "-Y": (0, -1, 0), "+Z": (0, 0, 1), "-Z": (0, 0, -1)}


def seen(emitter):
    """What one sees of a sky, in the six directions and a little aside."""
    light = {}
    for name, axis in AXES.items():
        towards = np.array(axis) + 0.04
        scene = mi.load_dict({
            "type": "scene", "sky": emitter, "integrator": {"type": "path"},
            "sensor": {"type": "perspective", "fov": 1,
                       "to_world": mi.ScalarTransform4f().look_at([0, 0, 0], list(towards), [0.3, 0.5, 0.8]),
                       "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}}}})  # fmt: skip
        light[name] = round(float(np.array(mi.render(scene, spp=4)).mean()), 3)
    return light


picture = np.zeros((8, 16, 3), np.float32)
picture[:4] = 1
panorama = seen({"type": "envmap", "bitmap": mi.Bitmap(picture)})
sky = {"type": "sunsky", "turbidity": 3.0, "sun_scale": 0.0, "sun_direction": [0.6, 0.0, 0.8]}
plain = seen(sky)
turned = seen({"type": "sunsky", "turbidity": 3.0, "sun_scale": 0.0, "sun_direction": [0.6, 0.8, 0.0],
               "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], -90)})  # fmt: skip
for name, light in (("envmap", panorama), ("sunsky", plain), ("sunsky, turned", turned)):
    print("found:", name, light)
assert panorama["+Y"] == 1 and panorama["-Y"] == 0
assert plain["-Z"] == 0 and all(plain[axis] > 0 for axis in AXES if axis != "-Z")
assert turned["-Y"] == 0 and all(turned[axis] > 0 for axis in AXES if axis != "-Y")
PYTHON
venv/bin/python sky.py | grep "^found: "
