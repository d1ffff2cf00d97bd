#!/usr/bin/env bash
# LuxCore (mappoint): the candela of an IES file do not count, and its downlight shines up.
#
# Expected: a lamp of 200 candela is twice as bright as one of 100, and vertical angle 0 is straight down (LM-63), -Z here.
#           A profile that is the same to all sides gives the light of a `point` of the same colour.
# Found:    both lamps have the same light, that of a fixed power. Angle 0 is +Z, the floor below stays black. `flipz` mirrors
#           the profile, so C90 stays at +Y. The even profile is 4 pi times darker than a `point`.
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


def profile(name, angles, candela):
    """An IES file of candela that depend on the vertical angle alone."""
    with open(name, "w") as file:
        file.write(f"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 {len(angles)} 1 1 2 0 0 0\n1 1 10\n"
                   + " ".join(map(str, angles)) + "\n0\n" + " ".join(map(str, candela)) + "\n")


def properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        made.Set(pyluxcore.Property(name, list(value) if isinstance(value, list) else [value]))
    return made


def intensity(light, up):
    """What a lamp at the origin sends up or down, 17 degrees off the axis, from a picture of a matte plate."""
    z = 10.0 if up else -10.0
    scene = pyluxcore.Scene()
    corners = [(-5.0, -5.0, z), (5.0, -5.0, z), (5.0, 5.0, z), (-5.0, 5.0, z)]
    scene.DefineMesh("mesh", corners, [(0, 1, 2), (0, 2, 3)], None, None, None, None)
    scene.Parse(properties({
        "scene.lights.lamp.position": [0.0, 0.0, 0.0], "scene.lights.lamp.color": [1.0, 1.0, 1.0],
        **{f"scene.lights.lamp.{name}": value for name, value in light.items()},
        "scene.materials.surface.type": "matte", "scene.materials.surface.kd": [0.5, 0.5, 0.5],
        "scene.objects.thing.shape": "mesh", "scene.objects.thing.material": "surface",
        "scene.camera.type": "perspective", "scene.camera.lookat.orig": [1.5, 0.0, z / 2],
        "scene.camera.lookat.target": [3.0, 0.0, z], "scene.camera.up": [0.0, 1.0, 0.0], "scene.camera.fieldofview": 0.5}))
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties({
        "renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "film.width": 8, "film.height": 8, "film.filter.type": "NONE",
        "batch.haltspp": 64, "film.imagepipelines.0.0.type": "NOP", "path.pathdepth.total": 2}), scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    pixels = np.zeros(8 * 8 * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
    session.Stop()
    return float(pixels.mean()) / (0.5 / np.pi) * 109**1.5 / 10


pyluxcore.Init()
profile("even.ies", range(0, 181, 10), [100] * 19)
profile("down100.ies", range(0, 91, 10), [100] * 10)
profile("down200.ies", range(0, 91, 10), [200] * 10)
lamp = {"type": "mappoint"}
found = {name: [round(intensity({**lamp, "iesfile": f"{name}.ies"}, up), 5) for up in (False, True)]
         for name in ("even", "down100", "down200")}
flipped = intensity({**lamp, "iesfile": "down100.ies", "flipz": True}, False)
point = intensity({"type": "point"}, False)
print("found, down and up:", found, "- flipz, down:", flipped, "- point:", point)
assert found["down100"][0] < 1e-4 and found["down200"][0] < 1e-4
assert found["down100"][1] > 0.01 and abs(found["down200"][1] / found["down100"][1] - 1) < 0.02
assert abs(flipped / found["down100"][1] - 1) < 0.02 and abs(point / found["even"][0] / (4 * np.pi) - 1) < 0.03
PYTHON
venv/bin/python lux.py >log 2>&1 || { tail -20 log; exit 1; }
grep found, log
