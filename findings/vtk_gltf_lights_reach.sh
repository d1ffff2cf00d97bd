#!/usr/bin/env bash
# VTK (vtkGLTFImporter): lamps are as bright far away as near.
#
# Expected: points and spots of KHR_lights_punctual fall off with the square of the distance, candela over metres squared.
# Found:    a lamp without a range has VTK's own attenuation of 1, 0, 0: none. At 10 m it is 100 times too bright, at 0.1 m 100
#           times too dark. With a range of r it is divided by 1 + 100 d^2 / r^2: for 5 m that is 4 to 5 times too dark from
#           a metre on. So the range, which only cuts off far away, sets the brightness. Cone and colour are right.
# Tried:    vtk 9.7.2 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q vtk==9.7.2
cat >lamps.py <<'PYTHON'
import base64
import json
import math
import struct

import vtk

corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
lights = [{"type": "point", "intensity": 100, "range": 5}, {"type": "spot", "intensity": 40, "color": [1, 0.5, 0.25],
                                                             "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}}]
with open("lamps.gltf", "w") as file:
    json.dump({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}], "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": lights}},
        "nodes": [{"mesh": 0}] + [{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(2)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{
            "byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}]}, file)
importer = vtk.vtkGLTFImporter()
importer.SetFileName("lamps.gltf")
importer.Update()
found, lamps = importer.GetRenderer().GetLights(), {}
for light in (found.GetItemAsObject(i) for i in range(found.GetNumberOfItems())):
    lamps[light.GetIntensity()] = light
    print("found:", light.GetIntensity(), light.GetDiffuseColor(), "attenuation", light.GetAttenuationValues(), "cone",
          light.GetConeAngle())
point, spot = lamps[100], lamps[40]
assert len(lamps) == 2 and point.GetPositional() and spot.GetPositional() and spot.GetAttenuationValues() == (1, 0, 0)
assert all(math.isclose(x, y, rel_tol=1e-5) for x, y in zip(point.GetAttenuationValues(), (1, 0, 4)))
assert math.isclose(spot.GetConeAngle(), math.degrees(0.6), rel_tol=1e-5) and spot.GetDiffuseColor() == (1, 0.5, 0.25)
PYTHON
venv/bin/python lamps.py 2>log || { tail -5 log; exit 1; }
