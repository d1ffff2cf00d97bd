#!/usr/bin/env bash
# usd-core: baking a skeleton's pose turns `normals`, and leaves primvars:normals, which count, as they were.
#
# Expected: UsdSkel.BakeSkinning puts points and normals into the pose. UsdGeomMesh says that primvars:normals take
#           precedence over `normals`, and Blender, glTF converters and Apple's tools write these.
# Found:    a joint turned by 90 degrees turns the points, and normals that stand in `normals`. Those in primvars:normals
#           still point where they did at rest: arms and legs are lit from the wrong side.
# Tried:    usd-core 26.11 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q usd-core==26.11
cat >bake.py <<'PYTHON'
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt


def baked(name):
    """Where a triangle's normal and its second corner point after a turn of 90 degrees about X."""
    stage = Usd.Stage.CreateInMemory()
    root = UsdSkel.Root.Define(stage, "/Root")
    skeleton = UsdSkel.Skeleton.Define(stage, "/Root/Skeleton")
    skeleton.CreateJointsAttr(["bone"])
    one = Vt.Matrix4dArray([Gf.Matrix4d(1)])
    skeleton.CreateBindTransformsAttr(one)
    skeleton.CreateRestTransformsAttr(one)
    motion = UsdSkel.Animation.Define(stage, "/Root/Motion")
    motion.CreateJointsAttr(["bone"])
    half = 0.5**0.5
    motion.CreateRotationsAttr().Set(Vt.QuatfArray([Gf.Quatf(half, half, 0, 0)]), 0.0)
    motion.CreateTranslationsAttr().Set(Vt.Vec3fArray([Gf.Vec3f(0)]), 0.0)
    motion.CreateScalesAttr().Set(Vt.Vec3hArray([Gf.Vec3h(1)]), 0.0)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([motion.GetPath()])
    mesh = UsdGeom.Mesh.Define(stage, "/Root/Mesh")
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreatePointsAttr([(0, 0, 0), (0, 1, 0), (1, 0, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    normals = [(0, 0, 1)] * 3
    if name == "normals":
        mesh.CreateNormalsAttr(normals)
        mesh.SetNormalsInterpolation("vertex")
    else:
        api = UsdGeom.PrimvarsAPI(mesh)
        api.CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "vertex").Set(normals)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0, 0, 0])
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0, 1.0, 1.0])
    assert UsdSkel.BakeSkinning(root, Gf.Interval(0, 0))
    found = mesh.GetPrim().GetAttribute(name).Get(0)[0]
    corner = mesh.GetPointsAttr().Get(0)[1]
    return [[round(x) + 0 for x in v] for v in (found, corner)]


as_attribute, as_primvar = baked("normals"), baked("primvars:normals")
print("found: normal and corner with `normals`", *as_attribute, "with primvars:normals", *as_primvar)
assert as_attribute == [[0, -1, 0], [0, 0, 1]] and as_primvar == [[0, 0, 1], [0, 0, 1]]
print("held")
PYTHON
venv/bin/python bake.py
