#!/usr/bin/env bash
# LuxCore (distant): a sun of half a degree is 17,000 times darker than one without a size.
#
# Expected: the colour of a `distant` light is its irradiance, as that of a `sharpdistant` is, and `theta` makes its shadows
#           softer. LuxCore's own `sun` keeps its light when `relsize` makes it ten times as wide.
# Found:    the colour is the radiance: a colour of 1 gives pi sin^2(theta), 0.00006 for a theta of 0.25 degrees, 0.79 for 30, and
#           without a size 1. theta is half of the angle across. A `spot` of colour 1 is 1 W/sr, a `point` 1 / (4 pi).
# Tried:    pyluxcore 2.11.2 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyluxcore==2.11.2 numpy==1.26.4
cat >lux.py <<'PYTHON'
import time

import numpy as np
import pyluxcore


def properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        made.Set(pyluxcore.Property(name, list(value) if isinstance(value, list) else [value]))
    return made


def irradiance(**light):
    """What a light above sends to a matte floor, from a picture of it."""
    scene = pyluxcore.Scene()
    corners = [(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)]
    scene.DefineMesh("mesh", corners, [(0, 1, 2), (0, 2, 3)], None, None, None, None)
    scene.Parse(properties({
        **{f"scene.lights.lamp.{name}": value for name, value in light.items()},
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
    return float(pixels.mean()) / (0.5 / np.pi)


pyluxcore.Init()
white, down = [1.0, 1.0, 1.0], [0.0, 0.0, -1.0]
disc = {theta: irradiance(type="distant", theta=theta, direction=down, color=white) for theta in (0.25, 1.0, 30.0)}
sharp = irradiance(type="sharpdistant", direction=down, color=white)
sun = [irradiance(type="sun", dir=[0.0, 0.0, 1.0], turbidity=3.0, relsize=size) for size in (1.0, 10.0)]
spot = 9 * irradiance(type="spot", position=[0.0, 0.0, 3.0], target=[0.0, 0.0, 0.0], coneangle=30.0, color=white)
point = 9 * irradiance(type="point", position=[0.0, 0.0, 3.0], color=white)
print("found: distant", disc, "- sharpdistant", sharp, "- sun", sun, "- spot", spot, "- point", point)
assert all(abs(value / (np.pi * np.sin(np.radians(theta)) ** 2) - 1) < 0.02 for theta, value in disc.items())
assert abs(sharp - 1) < 0.01 and abs(sun[1] / sun[0] - 1) < 0.01
assert abs(spot - 1) < 0.02 and abs(point * 4 * np.pi - 1) < 0.03
PYTHON
venv/bin/python lux.py >log 2>&1 || { tail -20 log; exit 1; }
grep found: log
