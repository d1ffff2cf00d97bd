#!/usr/bin/env bash
# LuxCore and Mitsuba: the same clear sky is 60,000 times brighter in one than in the other.
#
# Expected: `sun` and `sky2` of LuxCore and `sunsky` of Mitsuba are Hosek's and Wilkie's sky with a sun, in units that make a lamp
#           beside them right: LuxCore has W with an efficiency in lumen, Mitsuba radiance without a unit.
# Found:    at turbidity 3 and a sun 53 degrees high a floor gets 82,000 in LuxCore, which is lux of a clear day, and 1.25 in
#           Mitsuba, which is W/m2 for each nanometre. So exposures and lamps do not go from one to the other, nor beside
#           Blender's 120 for its own sky. Sun to sky agree within a factor of two.
# Tried:    pyluxcore 2.11.2, mitsuba 3.9.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyluxcore==2.11.2 mitsuba==3.9.1 numpy==1.26.4
cat >lux.py <<'PYTHON'
import json
import time

import numpy as np
import pyluxcore


def properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        made.Set(pyluxcore.Property(name, list(value) if isinstance(value, list) else [value]))
    return made


def irradiance(kind):
    """What a light gives to a matte floor, from a picture of it."""
    scene = pyluxcore.Scene()
    corners = [(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)]
    scene.DefineMesh("mesh", corners, [(0, 1, 2), (0, 2, 3)], None, None, None, None)
    scene.Parse(properties({
        "scene.lights.sky.type": kind, "scene.lights.sky.dir": [0.6, 0.0, 0.8], "scene.lights.sky.turbidity": 3.0,
        "scene.materials.surface.type": "matte", "scene.materials.surface.kd": [0.5, 0.5, 0.5],
        "scene.objects.thing.shape": "mesh", "scene.objects.thing.material": "surface",
        "scene.camera.type": "perspective", "scene.camera.lookat.orig": [0.0, 0.0, 1.0],
        "scene.camera.lookat.target": [0.0, 0.0, 0.0], "scene.camera.up": [0.0, 1.0, 0.0], "scene.camera.fieldofview": 1.0}))
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties({
        "renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "film.width": 8, "film.height": 8, "film.filter.type": "NONE",
        "batch.haltspp": 128, "film.imagepipelines.0.0.type": "NOP", "path.pathdepth.total": 2}), scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    pixels = np.zeros(8 * 8 * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
    session.Stop()
    return float(pixels[1::3].mean()) / (0.5 / np.pi)


pyluxcore.Init()
with open("lux.json", "w") as file:
    json.dump([irradiance("sun"), irradiance("sky2")], file)
PYTHON
cat >mitsuba_sky.py <<'PYTHON'
import json

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")


def irradiance(**scales):
    """The same for Mitsuba."""
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 2},
        "sky": {"type": "sunsky", "turbidity": 3.0, "sun_direction": [0.6, 0.0, 0.8], **scales},
        "floor": {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(9),
                  "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.5, 0.5, 0.5]}}},
        "sensor": {"type": "perspective", "fov": 1, "to_world": mi.ScalarTransform4f().look_at([0, 0, 1], [0, 0, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}}}})  # fmt: skip
    return float(np.array(mi.render(scene, spp=4096))[..., 1].mean()) / (0.5 / np.pi)


sky = irradiance(sun_scale=0.0)
mitsuba = [irradiance() - sky, sky]
with open("lux.json") as file:
    lux = json.load(file)
print("found: sun and sky, LuxCore", lux, "Mitsuba", mitsuba, "- together", sum(lux) / sum(mitsuba), "times")
assert abs(sum(lux) / 81600 - 1) < 0.05 and abs(sum(mitsuba) / 1.253 - 1) < 0.05
assert 0.5 < (lux[0] / lux[1]) / (mitsuba[0] / mitsuba[1]) < 2
PYTHON
venv/bin/python lux.py >log 2>&1 || { tail -20 log; exit 1; }
venv/bin/python mitsuba_sky.py
