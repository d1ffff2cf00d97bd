#!/usr/bin/env bash
# bpy: Image.save() to OpenEXR writes colours that are encoded for a display, without a word or with one that few know.
#
# Expected: OpenEXR holds linear light, so pixels come back in any program.
# Found:    a new float image becomes sRGB when a file name is set, and save() writes 0.735 for a pixel of 0.5. Blender
#           4.5.15 reads its own file back as linear 0.735. Blender 5.0.1 adds colorInteropID srgb_rec709_display and
#           reads 0.5 back; whoever does not know the attribute sees 0.735.
# Tried:    bpy 5.0.1 and 4.5.15, OpenEXR 3.4.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >save.py <<'PYTHON'
import os

import bpy

image = bpy.data.images.new("grey", 4, 4, float_buffer=True)
image.pixels.foreach_set([0.5] * 64)
image.filepath_raw, image.file_format = os.path.abspath("grey.exr"), "OPEN_EXR"
image.save()
loaded = bpy.data.images.load(image.filepath_raw)
print("blender:", bpy.app.version_string, image.colorspace_settings.name, loaded.colorspace_settings.name,
      f"{loaded.pixels[0]:.3f}")
PYTHON
cat >read.py <<'PYTHON'
import sys

import OpenEXR

with OpenEXR.File("grey.exr") as file:
    pixels = next(iter(file.channels().values())).pixels
    value, name = float(pixels.flat[0]), file.header().get("colorInteropID")
print(f"OpenEXR: {value:.3f} {name}")
assert abs(value - float(sys.argv[1])) < 1e-3 and str(name) == sys.argv[2]
PYTHON
for case in "5.0.1 sRGB 0.500 srgb_rec709_display" "4.5.15 Rec.709 0.735 None"; do
    read -r version space value name <<<"$case"
    python3.11 -m venv "$version"
    "$version/bin/pip" install -q "bpy==$version" OpenEXR==3.4.0
    "$version/bin/python" save.py | grep "^blender: .*$space $value"
    "$version/bin/python" read.py 0.735 "$name"
done
