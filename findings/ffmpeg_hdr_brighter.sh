#!/usr/bin/env bash
# ffmpeg (swscale): a 16-bit picture by PQ gets brighter on its way to the video levels of an AVIF or a movie.
#
# Expected: RGB of 16 bits becomes the nearest code of 10 or 12 bits; the light moves by less than a step, half a per cent.
# Found:    codes are 256/255 too far above black, up to 8 and 12 steps of 12 bits: 203 cd/m2 shows as 208, and 4,000 as
#           4,133. ffmpeg's other converter, zscale, has the nearest code.
# Tried:    the ffmpeg 9.0.2 of imageio-ffmpeg 0.8.1, PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q imageio-ffmpeg==0.8.1 numpy==2.4.6
cat >levels.py <<'PYTHON'
import subprocess

import imageio_ffmpeg
import numpy as np

M1, M2, C1, C2, C3 = 2610 / 16384, 2523 / 32, 107 / 128, 2413 / 128, 2392 / 128  # SMPTE ST 2084
BITS = 12


def code(nits):
    y = (nits / 10000) ** M1
    return ((C1 + C2 * y) / (1 + C3 * y)) ** M2


def nits(value):
    root = value ** (1 / M2)
    return 10000 * (max(root - C1, 0) / (C2 - C3 * root)) ** (1 / M1)


def luma(level, converter):
    """The first code of a grey picture of 16 bits behind a converter."""
    grey = np.full((16, 16, 3), round(level * 65535), "<u2").tobytes()
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb48le",
               "-s", "16x16", "-i", "-", "-vf", f"{converter},format=yuv444p{BITS}le", "-f", "rawvideo", "-"]
    return int(np.frombuffer(subprocess.run(command, input=grey, capture_output=True, check=True).stdout, "<u2")[0])


step = 2 ** (BITS - 8)
for light in (203, 4000):
    exact = step * (16 + 219 * code(light))
    plain = luma(code(light), "scale=out_color_matrix=bt2020nc:out_range=tv")
    other = luma(code(light), "zscale=matrix=2020_ncl:range=limited")
    shown = nits((plain / step - 16) / 219)
    print(f"found: {light} cd/m2, exact code {exact:.1f}: scale {plain}, shown as {shown:.0f} cd/m2; zscale {other}")
    assert abs(other - exact) <= 0.5
    assert abs((plain - 16 * step) / (exact - 16 * step) - 256 / 255) < 5e-4 and shown / light > 1.02
PYTHON
venv/bin/python levels.py
