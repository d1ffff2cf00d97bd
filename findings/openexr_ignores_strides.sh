#!/usr/bin/env bash
# OpenEXR of PyPI: a crop, a turned picture or every second row of an array is written as other pixels.
#
# Expected: File({...}, {"RGB": array}).write() writes the array as NumPy shows it, or refuses one whose pixels are not
#           next to each other, as it refuses float64.
# Found:    it writes the pixels that follow the first one in memory. panorama[:, 2:6] has the wrong columns from its
#           second row on, panorama[::2] is the upper half, and a transposed picture is not transposed. Nothing is
#           said. numpy.ascontiguousarray() before the call helps.
# Tried:    OpenEXR 3.5.3 and numpy of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 numpy
cat >strides.py <<'PYTHON'
import numpy as np
import OpenEXR


def written(array):
    """What the file has after the array was written to it."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": array}).write("view.exr")
    with OpenEXR.File("view.exr") as file:
        return np.array(file.channels()["RGB"].pixels)


panorama = np.arange(4 * 8 * 3, dtype=np.float32).reshape(4, 8, 3)
assert np.array_equal(written(panorama), panorama)
views = {"crop": panorama[:, 2:6], "every second row": panorama[::2], "transposed": panorama.transpose(1, 0, 2)}
for name, view in views.items():
    file = written(view)
    print("found:", name, "row 1 begins with", *view[1, 0], "and the file's with", *file[1, 0])
    assert file.shape == view.shape and not np.array_equal(file, view)
    assert np.array_equal(written(np.ascontiguousarray(view)), view)
assert np.array_equal(written(panorama[::2]), panorama[:2])
PYTHON
venv/bin/python strides.py
