#!/usr/bin/env bash
# embreex: query='OCCLUDED' answers 0 for a blocked ray and -1 for a free one.
#
# Expected: a truth value, or Embree's own sign: blocked is true.
# Found:    int32, 0 where something blocks the ray and -1 where nothing does, so `if` on an answer, and .any() on
#           many, mean the opposite. query='DISTANCE' answers 1e37 for a miss, which is no infinity, and distances
#           count in lengths of the direction, which need not be 1.
# Tried:    embreex 4.4.0.post1, numpy 2.3.5 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install -q embreex==4.4.0.post1 numpy==2.3.5
venv/bin/python - <<'PYTHON'
import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

scene = rtcore_scene.EmbreeScene()
TriangleMesh(scene, np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]]], np.float32))
origins = np.array([[0, 0, 2], [0, 0, 2], [5, 0, 2]], np.float32)
directions = np.array([[0, 0, -1], [0, 0, -4], [0, 0, -1]], np.float32)
blocked = scene.run(origins, directions, query="OCCLUDED")
distances = scene.run(origins, directions, query="DISTANCE")
print("OCCLUDED, hit, hit, miss:", blocked, blocked.dtype)
print("DISTANCE, hit, hit, miss:", distances)
assert blocked.tolist() == [0, 0, -1]
assert np.allclose(distances[:2], [2.0, 0.5]) and distances[2] == np.float32(1e37) and np.isfinite(distances[2])
PYTHON
