#!/usr/bin/env bash
# usd-core: BakeSkinning() of a moment between two samples of an animation bakes nothing and says it did.
#
# Expected: UsdSkel.BakeSkinning(root, Interval(5, 5)) gives the pose at 5, since the animation is interpolated there, as
#           all of USD is: translations at 0 and 10 have a value at 5.
# Found:    it returns True and the points stay at rest at 5. With a sample at 5 itself they are posed.
# Tried:    usd-core 26.11 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q usd-core==26.11
cat >bake.py <<'PYTHON'
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt


def baked(times):
    """z of the first point at 5, of a mesh on one joint that rises by the time."""
    stage = Usd.Stage.CreateInMemory()
    root = UsdSkel.Root.Define(stage, "/R")
    skeleton = UsdSkel.Skeleton.Define(stage, "/R/S")
    skeleton.CreateJointsAttr(["a"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)])
    animation = UsdSkel.Animation.Define(stage, "/R/A")
    animation.CreateJointsAttr(["a"])
    animation.CreateRotationsAttr([Gf.Quatf(1)])
    animation.CreateScalesAttr(Vt.Vec3hArray([Gf.Vec3h(1)]))
    for time in times:
        animation.CreateTranslationsAttr().Set([Gf.Vec3f(0, 0, time)], time)
    assert animation.GetTranslationsAttr().Get(5)[0][2] == 5
    mesh = UsdGeom.Mesh.Define(stage, "/R/M")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    for prim in (skeleton.GetPrim(), mesh.GetPrim()):
        binding = UsdSkel.BindingAPI.Apply(prim)
        binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    UsdSkel.BindingAPI(skeleton).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    binding.CreateJointIndicesPrimvar(True, 1).Set([0])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    assert UsdSkel.BakeSkinning(root, Gf.Interval(5, 5))
    return mesh.GetPointsAttr().Get(5)[0][2]


found = baked((0, 10)), baked((0, 5, 10))
print("found: z", found[0], "between samples,", found[1], "at one")
assert found == (0, 5)
print("held")
PYTHON
venv/bin/python bake.py
