#!/usr/bin/env bash
# bpy (Cycles): a script's first render is denoised, and its indirect light is clamped.
#
# Expected: without an interface nothing is denoised unless one asks for it; a picture's mean is that of the scene.
# Found:    in an empty scene of factory settings denoising is on, sample_clamp_indirect is 10, blur_glossy is 1, adaptive
#           sampling stops at 0.01, and matt surfaces send light on 4 times.
# Tried:    bpy 5.0.1 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q bpy==5.0.1
cat >defaults.py <<'PYTHON'
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
cycles = bpy.context.scene.cycles
found = {
    "use_denoising": cycles.use_denoising, "sample_clamp_indirect": cycles.sample_clamp_indirect, "blur_glossy": cycles.blur_glossy,
    "use_adaptive_sampling": cycles.use_adaptive_sampling, "adaptive_threshold": round(cycles.adaptive_threshold, 4),
    "diffuse_bounces": cycles.diffuse_bounces,
}  # fmt: skip
print("found:", found)
assert list(found.values()) == [True, 10.0, 1.0, True, 0.01, 4]
PYTHON
venv/bin/python defaults.py | grep "^found: "
