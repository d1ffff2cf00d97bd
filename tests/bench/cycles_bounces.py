#!/usr/bin/env python3
"""Lights one mesh with Relumine and with Blender's Cycles, bounces included, and compares them.

    tests/bench/cycles_bounces.py MESH.ply ENV.exr [--relumine PROGRAM] [--samples 64] [--bounces 4]
                                  [--albedo 0.8] [--reference 4096] [--folder DIR]

Cycles bakes its diffuse pass, direct and indirect, to the vertices. The reference is Cycles itself
with many samples. Errors are relative L2 over all vertices. The program prints its times: Relumine's
precompute is made once for a mesh, its relight once for each environment, Cycles' bake each time.
Needs `blender` and numpy.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh")
    parser.add_argument("environment")
    parser.add_argument("--relumine", default="build/release/app/relumine")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--albedo", type=float, default=0.8)
    parser.add_argument("--reference", type=int, default=4096)
    parser.add_argument("--folder", default=".", help="where the files of the comparison go")
    given = parser.parse_args()
    folder = Path(given.folder)
    folder.mkdir(parents=True, exist_ok=True)

    def relumine(*words):
        done = subprocess.run([given.relumine, *words, "--json"], check=True, stdout=subprocess.PIPE)
        return json.loads(done.stdout)

    scene, world, relit = (str(folder / name) for name in ("bench.prt", "world.exr", "relit.npy"))
    made = relumine("precompute", given.mesh, "--bounces", "-o", scene)
    lit = relumine("relight", scene, given.environment, "-o", relit, "--bounces",
                   str(given.bounces), "--albedo", str(given.albedo))
    relumine("env", "convert", given.environment, "--to", "blender", "-o", world)

    def cycles(samples):
        output = str(folder / f"cycles_{samples}.npy")
        done = subprocess.run(
            ["blender", "-b", "--factory-startup", "-P", str(Path(__file__).with_name("cycles_bake.py")), "--", given.mesh, world,
             str(samples), str(given.bounces), str(given.albedo), output],
            check=True, stdout=subprocess.PIPE, text=True)
        times = [line.split() for line in done.stdout.splitlines() if "baked in" in line]
        if not times:
            sys.exit("Blender baked nothing:\n" + done.stdout[-2000:])
        return numpy.load(output).astype(float), float(times[0][2]), float(times[0][4])

    fast, fast_seconds, fast_processor = cycles(given.samples)
    reference, reference_seconds, reference_processor = cycles(given.reference)
    # .npy has radiance times the albedo, the diffuse pass is for albedo 1.
    own = numpy.load(relit).astype(float) / given.albedo

    def error(light):
        return numpy.linalg.norm(light - reference) / numpy.linalg.norm(reference)

    print(f"{len(own)} vertices, albedo {given.albedo}, {given.bounces} bounces")
    print(f"Cycles, {given.samples} samples: {fast_seconds:.2f} s ({fast_processor:.2f} s of "
          f"processors), relative L2 {error(fast):.4f}")
    print(f"Relumine: precompute {made['seconds']:.1f} s once; relight "
          f"{lit['seconds_relight'] + lit['seconds_bin'] + lit['seconds_trace']:.4f} s + bounces "
          f"{lit['seconds_bounces']:.4f} s, relative L2 {error(own):.4f}")
    print(f"Cycles, {given.reference} samples: {reference_seconds:.1f} s ({reference_processor:.1f} "
          f"s of processors), the reference; its noise is about {error(fast) * (given.samples / given.reference) ** 0.5:.4f}")


main()
