#!/usr/bin/env bash
# Mitsuba (envmap): the parameter `data` is two columns wider than the picture that was given.
#
# Expected: `data` has the picture's shape, or one column more, as in versions before, where the first is repeated.
# Found:    a picture of 8 x 4 becomes 10 x 4: the last column stands before the first, and the first behind the last. So
#           who sets `data`, or steps along its gradient, has to take care of the copies.
# Tried:    mitsuba 3.9.1 of PyPI (scalar_rgb), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q mitsuba==3.9.1 numpy==1.26.4
cat >columns.py <<'PYTHON'
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
picture = np.arange(4 * 8 * 3, dtype=np.float32).reshape(4, 8, 3)
scene = mi.load_dict({"type": "scene", "dome": {"type": "envmap", "bitmap": mi.Bitmap(picture)}})
data = np.array(mi.traverse(scene)["dome.data"])
print(f"found: {picture.shape} becomes {data.shape}")
assert data.shape == (4, 10, 3)
assert (data[:, 1:-1] == picture).all() and (data[:, 0] == picture[:, -1]).all() and (data[:, -1] == picture[:, 0]).all()
PYTHON
venv/bin/python columns.py | grep "^found: "
