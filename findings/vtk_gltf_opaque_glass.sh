#!/usr/bin/env bash
# VTK (vtkGLTFExporter): what is transparent is opaque in the file.
#
# Expected: an actor of opacity 0.4 becomes a material that lets 60 % through: alphaMode BLEND and an alpha of 0.4.
# Found:    the alpha is written, alphaMode is not, and glTF's default is OPAQUE, for which alpha does not count. Hulls and
#           glass of a scene hide what they showed. PyVista's export_gltf() calls it. Emission is left out as well.
# Tried:    vtk 9.7.2 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q vtk==9.7.2
cat >glass.py <<'PYTHON'
import json

import vtk

ball, mapper, actor = vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
mapper.SetInputConnection(ball.GetOutputPort())
actor.SetMapper(mapper)
look = actor.GetProperty()
look.SetInterpolationToPBR()
look.SetColor(0.5, 0.25, 1)
look.SetOpacity(0.4)
look.SetEmissiveFactor(0.1, 0.2, 0.3)
renderer, window, exporter = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkGLTFExporter()
renderer.AddActor(actor)
window.OffScreenRenderingOn()
window.AddRenderer(renderer)
exporter.SetRenderWindow(window)
exporter.SetFileName("ball.gltf")
exporter.Write()
with open("ball.gltf") as file:
    (material,) = json.load(file)["materials"]
print("found:", material)
assert abs(material["pbrMetallicRoughness"]["baseColorFactor"][3] - 0.4) < 1e-6
assert "alphaMode" not in material and "emissiveFactor" not in material
PYTHON
venv/bin/python glass.py 2>log || { tail -20 log; exit 1; }
