#!/usr/bin/env bash
# LuxCore (PATHCPU): a picture lies one row lower than the camera says.
#
# Expected: of 8 rows of a camera at height 0 that looks straight ahead, a white square above height 0 fills the upper 4.
# Found:    it fills the upper 5: each row shows what belongs one row higher. Filters (NONE, BOX, BLACKMANHARRIS) change
#           nothing. FilmOutputType.RGB was turned over, as its lower row comes first.
# Tried:    pyluxcore 2.11.2 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyluxcore==2.11.2 numpy==1.26.4
cat >lux.py <<'PYTHON'
import os
import time

import numpy as np
import pyluxcore


def properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        made.Set(pyluxcore.Property(name, list(value) if isinstance(value, (list, tuple)) else [value]))
    return made


def ball(rings=24):
    """(corners, triangles, normals) of a sphere of radius 1."""
    points = [
        (np.sin(t) * np.sin(p), np.cos(t), np.sin(t) * np.cos(p))
        for t in np.linspace(0, np.pi, rings + 1) for p in np.linspace(0, 2 * np.pi, 2 * rings + 1)
    ]  # fmt: skip
    points = [tuple(map(float, each)) for each in points]
    row = 2 * rings + 1
    corners = [ring * row + each for ring in range(rings) for each in range(2 * rings)]
    return points, [each for c in corners for each in ((c, c + row, c + row + 1), (c, c + row + 1, c + 1))], points


def shown(rows, mesh, eye=(0.0, 0.0, 5.0), depth=16, fov=8.0, samples=128):
    """The rows of a picture of a mesh of material "surface"; `rows` has materials and lights."""
    scene = pyluxcore.Scene()
    points, triangles, normals = mesh
    scene.DefineMesh("mesh", points, triangles, normals, None, None, None)
    scene.Parse(properties({
        **rows, "scene.objects.thing.shape": "mesh", "scene.objects.thing.material": "surface",
        "scene.camera.type": "perspective", "scene.camera.lookat.orig": eye, "scene.camera.lookat.target": [0.0, 0.0, 0.0],
        "scene.camera.up": [0.0, 1.0, 0.0] if eye[1] == 0.0 else [0.0, 0.0, 1.0], "scene.camera.fieldofview": fov,
    }))  # fmt: skip
    depths = {f"path.pathdepth.{name}": depth for name in ("total", "diffuse", "glossy", "specular")}
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties({
        "renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "film.width": 8, "film.height": 8, "film.filter.type": "NONE",
        "batch.haltspp": samples, "film.imagepipelines.0.0.type": "NOP", "path.russianroulette.depth": 64, **depths,
    }), scene))  # fmt: skip
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    pixels = np.zeros(8 * 8 * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
    session.Stop()
    return pixels.reshape(8, 8, 3)[::-1].mean((1, 2))  # the upper row first


WHITE_SKY = {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": [1.0, 1.0, 1.0]}
pyluxcore.Init()
square = ([(-9.0, 0.0, 0.0), (9.0, 0.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)], [(0, 1, 2), (0, 2, 3)], None)
glow = {"scene.materials.surface.type": "matte", "scene.materials.surface.kd": [0.0] * 3, "scene.materials.surface.emission": [1.0] * 3}
rows = shown(glow, square, samples=256)
print("found:", " ".join(f"{each:.2f}" for each in rows), flush=True)
assert (abs(rows[:5] - 1) < 0.01).all() and (rows[5:] < 0.01).all()
os._exit(0)
PYTHON
venv/bin/python lux.py 2>&1 | grep "^found: " && [ "${PIPESTATUS[0]}" = 0 ]
