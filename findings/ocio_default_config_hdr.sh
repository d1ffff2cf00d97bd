#!/usr/bin/env bash
# OpenColorIO (ocio://default): a .hdr is a picture for a display, and an .exr has the primaries of ACES2065-1.
#
# Expected: the rules for file names give linear Rec. 709, or the role scene_linear, to .hdr and .exr: both hold light.
# Found:    "sRGB - Display" for .hdr, so 0.5 of a panorama becomes 0.214 and its sun of 1,000 becomes 13.9 million. An .exr
#           is ACES2065-1: a red of (1, 0, 0) becomes (2.5, -0.28, -0.015) in Rec. 709. The configs up to v2.2.0 say
#           ACES2065-1 for everything, .png as well.
# Tried:    opencolorio 2.6.0 of PyPI (cg-config-v5.0.0_aces-v2.1_ocio-v2.6), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q opencolorio==2.6.0
cat >rules.py <<'PYTHON'
import PyOpenColorIO as ocio

config = ocio.Config.CreateFromBuiltinConfig("ocio://default")
space = {name: config.getColorSpaceFromFilepath(name)[0] for name in ("sky.hdr", "sky.exr")}
print("found:", space)


def linear(name, pixel):
    """A pixel of a file, in linear Rec. 709, when one goes by the rules."""
    return config.getProcessor(space[name], "lin_rec709_scene").getDefaultCPUProcessor().applyRGB(pixel)


half, sun, red = linear("sky.hdr", [0.5] * 3), linear("sky.hdr", [1000] * 3), linear("sky.exr", [1, 0, 0])
print("0.5 and 1000 of a .hdr become", half[0], sun[0], "and red of an .exr becomes", red)
assert abs(half[0] - 0.214) < 1e-3 and sun[0] > 1e7
assert red[0] > 2.5 and red[1] < -0.27
old = ocio.Config.CreateFromBuiltinConfig("cg-config-v2.2.0_aces-v1.3_ocio-v2.4")
assert {old.getColorSpaceFromFilepath(name)[0] for name in ("sky.hdr", "sky.exr", "wood.png")} == {"ACES2065-1"}
PYTHON
venv/bin/python rules.py
