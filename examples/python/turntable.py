"""A turntable: the camera goes around the mesh, then the light: turntable.py SCENE.prt ENVIRONMENT
OUT.png [FRAMES]. All frames are in one picture, the camera's in the upper row."""

import sys

import numpy as np

import relumine

if len(sys.argv) < 4:
    sys.exit("turntable.py SCENE.prt ENVIRONMENT OUT.png [FRAMES]")
path, environment_path, output = sys.argv[1:4]
frames = int(sys.argv[4]) if len(sys.argv) > 4 else 6
relighter = relumine.Relighter(relumine.Scene.load(path))
environment = relumine.Environment.load(environment_path)
angles = np.linspace(0, 360, frames, endpoint=False)

relighter.set_environment(environment)
exposure = relighter.picture(size=(64, 48)).exposure  # one for all
camera = [relighter.picture(size=(240, 180), camera=(angle, 20)) for angle in angles]
light = []
for angle in angles:
    relighter.set_environment(environment.turned(rotate=angle))
    light.append(relighter.picture(size=(240, 180)))

rows = np.concatenate([np.concatenate(camera, axis=1), np.concatenate(light, axis=1)])
relumine.Picture(rows, exposure=exposure).save(output)
