"""Round trips: what tools make of glTF files, and how far the picture goes.

    python round_trips.py ENVIRONMENT ASSET.glb... [--also TOOL=FOLDER] [--pose POSE] [--keep FOLDER]

Each asset goes through operations of gltf-transform (npm install -g @gltf-transform/cli). FOLDER has
files of the same names that other tools wrote. Prints the mean and the largest difference of the
pictures before and after, of 255, and how many pixels differ by more than 8. NumPy and Pillow.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np
from PIL import Image

PROGRAM = os.environ.get("RELUMINE_PROGRAM", "relumine")
OPERATIONS = {
    "draco": ["draco"],
    "meshopt": ["meshopt"],
    "quantize": ["quantize"],
    "weld": ["weld"],
    "join": ["join"],
    "palette": ["palette", "--min", "1"],
    "webp": ["webp"],
    "optimize": ["optimize", "--compress", "meshopt", "--texture-compress", "webp"],
}


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], check=True, capture_output=True, text=True).stdout


def view_of(asset, pose):
    """The same camera for all files of an asset."""
    info = json.loads(run(PROGRAM, "info", asset, "--json", *pose))
    low, high = np.array(info["min"]), np.array(info["max"])
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    eye = middle + size * np.array([0.35, 0.25, 1.5])
    return ["--eye", ",".join(map(str, eye)), "--target", ",".join(map(str, middle)), "--fov", "35"]


def picture(asset, environment, view, pose, png):
    """Without more vertices and bounces, so that nothing but the file decides."""
    scene = png.with_suffix(".prt")
    quick = ["--refine", "off", "--bounces", "0", "--tolerance", "0.1", "--face-resolution", "32"]
    run(PROGRAM, "precompute", asset, "-o", scene, "-q", *quick, *pose)
    run(PROGRAM, "relight", scene, environment, "-o", png, "-q", "--size", "320x240", "--exposure", "0.35", *view)
    scene.unlink()
    return np.asarray(Image.open(png).convert("RGB")).astype(int)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("environment", type=pathlib.Path)
    parser.add_argument("assets", type=pathlib.Path, nargs="+")
    parser.add_argument("--also", action="append", default=[])
    parser.add_argument("--pose")
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    folder = options.keep or pathlib.Path(tempfile.mkdtemp())
    folder.mkdir(exist_ok=True)
    for asset in options.assets:
        pose = ["--pose", options.pose] if options.pose else []
        view = view_of(asset, pose)
        before = picture(asset, options.environment, view, pose, folder / f"{asset.stem}.png")
        files = {tool: pathlib.Path(path) / asset.name for tool, path in (o.split("=", 1) for o in options.also)}
        for name, (operation, *rest) in OPERATIONS.items():
            files[name] = folder / f"{asset.stem}.{name}.glb"
            run("gltf-transform", operation, asset, files[name], *rest)
        for name, file in files.items():
            after = picture(file, options.environment, view, pose, folder / f"{asset.stem}.{name}.png")
            error = np.abs(after - before)
            print(f"{asset.stem:24} {name:10} {error.mean():6.3f} {error.max():4d} {(error.max(2) > 8).mean():8.2%}")


main()
