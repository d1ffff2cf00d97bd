#!/usr/bin/env python3
"""Writes pictures as one animated GIF that repeats for ever.

    docs/animated.py OUT.gif [--milliseconds 100] PICTURE...

Each frame has its own palette of 256 colours; errors are diffused, so that skies have no bands.
Needs Pillow (Debian's python3-pil).
"""

import argparse
import sys

from PIL import Image


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output")
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--milliseconds", type=int, default=100, help="how long a frame is seen")
    given = parser.parse_args()
    frames = [Image.open(name).convert("RGB") for name in given.pictures]
    for name, frame in zip(given.pictures, frames):
        if frame.size != frames[0].size:
            sys.exit(f"{name}: expected {frames[0].size} pixels, got {frame.size}")
    # Quantized to its own palette first: only with a palette given does Pillow diffuse errors.
    first, *others = (frame.quantize(palette=frame.quantize(256), dither=Image.Dither.FLOYDSTEINBERG) for frame in frames)
    first.save(given.output, save_all=True, append_images=others, duration=given.milliseconds, loop=0, optimize=False)


if __name__ == "__main__":
    main()
