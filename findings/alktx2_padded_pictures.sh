#!/usr/bin/env bash
# alktx2 (KTX 2 to PNG): a picture comes back larger than it was, with rows and columns that it never had.
#
# Expected: a KTX 2 file of 13 x 7 pixels becomes a PNG of 13 x 7. The header says that size, and so does the package's own
#           inspect_ktx2().
# Found:    the PNG has 16 x 8, whole blocks of 4 x 4. uvs of a mesh go over the padding, too, so its texture is squeezed by
#           13/16 and has an edge of other colours. opengl-basisu decodes the same file to 13 x 7.
# Tried:    alktx2 0.1.7, opengl-basisu 0.1.0a2, pillow 13.0.0, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q alktx2==0.1.7 opengl-basisu==0.1.0a2 pillow==13.0.0
cat >size.py <<'PYTHON'
import io

import alktx2
import numpy as np
import opengl_basisu
from PIL import Image

WIDTH, HEIGHT = 13, 7
pixels = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
pixels[..., 0] = 19 * np.arange(WIDTH)
Image.fromarray(pixels).save("in.png")
for codec in ("etc1s", "uastc"):
    alktx2.encode_image_to_ktx2("in.png", "a.ktx2", codec=codec)
    with open("a.ktx2", "rb") as file:
        data = file.read()
    said = alktx2.inspect_ktx2(data)
    alktx2.decode_ktx2_to_image("a.ktx2", "file.png")
    sizes = [
        Image.open(io.BytesIO(alktx2.decode_ktx2_to_bytes(data, format="png")[0])).size,
        Image.open("file.png").size,
        opengl_basisu.open(data).transcode("rgba8").data.shape[1::-1],
    ]
    print("found:", codec, "of", (said["width"], said["height"]), "becomes", *sizes)
    assert (said["width"], said["height"]) == (WIDTH, HEIGHT) == sizes[2]
    assert sizes[:2] == [(16, 8), (16, 8)]
print("held")
PYTHON
venv/bin/python size.py
