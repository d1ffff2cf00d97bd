"""Relight in six lines: relight.py MESH ENVIRONMENT PICTURE.png"""

import sys

import relumine

if len(sys.argv) != 4:
    sys.exit("relight.py MESH ENVIRONMENT PICTURE.png")
mesh, environment, picture = sys.argv[1:]
scene = relumine.precompute(relumine.Mesh.load(mesh, floor=65), tolerance=0.03)
relighter = relumine.Relighter(scene)
relighter.set_environment(relumine.Environment.load(environment))
relighter.picture(size=(640, 480)).save(picture)
