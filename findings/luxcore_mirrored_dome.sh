#!/usr/bin/env bash
# LuxCore (infinite): a lat-long picture is shown mirrored.
#
# Expected: what is right of the picture's middle is to the right of someone who looks there from inside, +Z up, as in
#           Blender, three.js, Mitsuba and OpenEXR.
# Found:    it is to the left. With the picture's middle at -X and +Z up, what is right of it lights faces towards -Y,
#           which is to the left of someone who looks to -X. Up stays up. Add-ons turn the picture over before.
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
    """The mean of a picture of a mesh of material "surface"; `rows` has materials and lights."""
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
    return pixels.reshape(-1, 3).mean(0)


WHITE_SKY = {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": [1.0, 1.0, 1.0]}
pyluxcore.Init()
def dome(u, v):
    """A dark lat-long with one bright spot, as a file."""
    picture = np.full((32, 64, 3), 0.01, np.float32)
    picture[int(32 * v) - 2 : int(32 * v) + 3, int(64 * u) - 2 : int(64 * u) + 3] = 10
    name = f"dome{u}{v}.pfm"
    with open(name, "wb") as file:
        file.write(b"PF\n64 32\n-1.0\n" + picture[::-1].tobytes())
    return {"scene.lights.sky.type": "infinite", "scene.lights.sky.file": name, "scene.lights.sky.gamma": 1.0}


# A white square through the origin that faces each axis in turn.
axes = {}
for axis in range(3):
    for sign in (1.0, -1.0):
        normal = np.zeros(3)
        normal[axis] = sign
        a, b = np.roll(normal, 1), np.roll(normal, 2)
        if np.cross(a, b) @ normal < 0:
            a, b = b, a
        axes["+-"[sign < 0] + "XYZ"[axis]] = normal, [tuple(map(float, each)) for each in (-a - b, a - b, a + b, b - a)]
matt = {"scene.materials.surface.type": "matte", "scene.materials.surface.kd": [1.0] * 3}
for place, u, v, expected in (("middle", 0.5, 0.5, "-X"), ("right of it", 0.75, 0.5, "-Y"), ("top", 0.5, 0.1, "+Z")):
    light = {
        name: shown({**dome(u, v), **matt}, (points, [(0, 1, 2), (0, 2, 3)], None), eye=tuple(map(float, 5 * normal)), fov=1.0, samples=64)[0]
        for name, (normal, points) in axes.items()
    }  # fmt: skip
    found = max(light, key=light.get)
    print(f"found: {place} lights {found}", flush=True)
    assert found == expected
os._exit(0)
PYTHON
venv/bin/python lux.py 2>&1 | grep "^found: " && [ "${PIPESTATUS[0]}" = 0 ]
