#!/usr/bin/env bash
# trimesh (OBJ to glTF): lamps go out, glass is opaque, metal is none.
#
# Expected: what MTL and glTF both have comes through: Ke as emission, d and Tr as alpha, Pr and Pm as roughness and metallic, which
#           Blender and three.js' files carry. The reader keeps all of these in `kwargs`.
# Found:    the .glb has a base colour, a roughness and nothing else: no emission, no alpha, no metallic. Without Ns the roughness is
#           0.904, whatever Pr says, and metallicFactor is left out, which is 1 in glTF: so everything becomes metal. Lamp
#           and glass of one Kd become one material.
# Tried:    trimesh 5.2.0 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q trimesh==5.2.0 pillow==13.0.0
cat >all.mtl <<'MTL'
newmtl lamp
Kd 0.5 0.5 0.5
Ke 10 5 2
newmtl glass
Kd 0.5 0.5 0.5
d 0.25
newmtl metal
Kd 1 0.8 0.3
Pr 0.3
Pm 1
MTL
printf 'mtllib all.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n' >all.obj
for name in lamp glass metal; do printf 'o %s\nusemtl %s\nf 1/1 2/2 3/3\n' "$name" "$name" >>all.obj; done
cat >convert.py <<'PYTHON'
import json
import struct

import trimesh

scene = trimesh.load("all.obj", split_object=True)
read = {m.name: m.kwargs for m in (geometry.visual.material for geometry in scene.geometry.values())}
print("found: read", read)
scene.export("all.glb")
with open("all.glb", "rb") as file:
    data = file.read()
(length,) = struct.unpack_from("<I", data, 12)
written = json.loads(data[20:20 + length])["materials"]
for material in written:
    print("found: written", material)
assert read["lamp"]["ke"] == ["10", "5", "2"] and read["glass"]["d"] == ["0.25"] and read["metal"]["pm"] == ["1"]
assert len(written) == 2
for material in written:
    assert "extensions" not in material and max(material.get("emissiveFactor", [0])) == 0
    surface = material["pbrMetallicRoughness"]
    assert abs(surface["roughnessFactor"] - 0.9036) < 0.001 and surface["baseColorFactor"][3] == 1
    assert surface.get("metallicFactor", 1) == 1
PYTHON
venv/bin/python convert.py
