#!/usr/bin/env bash
# OpenImageIO: a PNG that is read and written has lost the colours where its alpha is low.
#
# Expected: a copy of a PNG has the same bytes. PNG stores colours that are not multiplied by alpha, and so do glTF's
#           textures whose alpha is data: strength of KHR_materials_specular, roughness of sheen, glossiness.
# Found:    the reader multiplies bytes by alpha, the writer divides them again: (200, 100, 50) becomes (255, 128, 0)
#           at alpha 2 and black at alpha 0. The hint oiio:UnassociatedAlpha of the input keeps them.
# Tried:    OpenImageIO 3.2.2.0 and pillow of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q OpenImageIO==3.2.2.0 pillow numpy
cat >copy.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio
from PIL import Image

texels = np.array([[(200, 100, 50, alpha) for alpha in (0, 2, 128, 255)]], np.uint8)
Image.fromarray(texels, "RGBA").save("texture.png")
oiio.ImageBuf("texture.png").write("copy.png")
copy = np.asarray(Image.open("copy.png"))
print("found:", texels[0].tolist(), "became", copy[0].tolist())
assert copy[0, 0].tolist() == [0, 0, 0, 0] and copy[0, 3].tolist() == [200, 100, 50, 255]
assert abs(int(copy[0, 1, 0]) - 200) > 40 and copy[0, 1, 3] == 2

hint = oiio.ImageSpec()
hint["oiio:UnassociatedAlpha"] = 1
oiio.ImageBuf("texture.png", 0, 0, hint).write("kept.png")
assert np.array_equal(np.asarray(Image.open("kept.png")), texels)
PYTHON
venv/bin/python copy.py
