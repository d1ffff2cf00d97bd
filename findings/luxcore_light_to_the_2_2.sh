#!/usr/bin/env bash
# LuxCore (infinite, imagemap): the light of an .exr or .hdr is raised to the power 2.2.
#
# Expected: floats are linear, as everywhere else; a gamma, if there is one by default, counts for pictures of 8 bits.
# Found:    an .exr of 0.5 is a sky of 0.218, and one of 2 a sky of 4.6; a sun of 50,000 would be one of 22 thousand
#           millions. Textures are the same: a reflectance of 0.5 becomes 0.218. `gamma` of 1 for the light, or the
#           texture, gives what the file says.
# Tried:    pyluxcore 2.11.2, OpenEXR 3.5.3 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyluxcore==2.11.2 numpy==1.26.4 OpenEXR==3.5.3
venv/bin/python - <<'PYTHON'
import numpy as np
import OpenEXR

for light in (0.5, 2.0):
    pixels = np.full((8, 16, 3), light, np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": pixels}).write(f"{light}.exr")
PYTHON
cat >lux.py <<'PYTHON'
import time

import numpy as np
import pyluxcore


def properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        made.Set(pyluxcore.Property(name, list(value) if isinstance(value, list) else [value]))
    return made


def shown(rows, plate=False):
    """The mean of a picture of the sky behind nothing, or of a plate of material "surface"."""
    scene = pyluxcore.Scene()
    if plate:
        corners = [(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)]
        scene.DefineMesh("mesh", corners, [(0, 1, 2), (0, 2, 3)], None, None, None, None)
        rows = {**rows, "scene.objects.thing.shape": "mesh", "scene.objects.thing.material": "surface"}
    scene.Parse(properties({
        **rows, "scene.camera.type": "perspective", "scene.camera.lookat.orig": [0.0, 0.0, 5.0],
        "scene.camera.lookat.target": [0.0, 0.0, 0.0], "scene.camera.up": [0.0, 1.0, 0.0], "scene.camera.fieldofview": 8.0}))
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties({
        "renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "film.width": 8, "film.height": 8, "film.filter.type": "NONE",
        "batch.haltspp": 16, "film.imagepipelines.0.0.type": "NOP"}), scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    pixels = np.zeros(8 * 8 * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
    session.Stop()
    return float(pixels.mean())


pyluxcore.Init()
dome = {"scene.lights.sky.type": "infinite"}
white = {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": [1.0, 1.0, 1.0],
         "scene.materials.surface.type": "matte", "scene.materials.surface.kd": "map", "scene.textures.map.type": "imagemap",
         "scene.textures.map.file": "0.5.exr"}
found = {light: shown({**dome, "scene.lights.sky.file": f"{light}.exr"}) for light in (0.5, 2.0)}
plain = shown({**dome, "scene.lights.sky.file": "2.0.exr", "scene.lights.sky.gamma": 1.0})
matte, matte_plain = shown(white, True), shown({**white, "scene.textures.map.gamma": 1.0}, True)
print("found:", found, "- with gamma 1:", plain, "- reflectance of 0.5:", matte, "- with gamma 1:", matte_plain)
assert all(abs(value / light**2.2 - 1) < 0.01 for light, value in found.items()) and abs(plain / 2 - 1) < 0.01
assert abs(matte / 0.5**2.2 - 1) < 0.02 and abs(matte_plain / 0.5 - 1) < 0.02
PYTHON
venv/bin/python lux.py >log 2>&1 || { tail -20 log; exit 1; }
grep found: log
