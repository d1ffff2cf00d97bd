#!/usr/bin/env bash
# usd-core: references to MaterialX files stay empty.
#
# Expected: a stage that refers to a .mtlx file has its materials, as OpenUSD's own builds have by their plug-in usdMtlx.
# Found:    the wheel has no such file format: "Could not open asset", and the prim has no children. The stage opens all
#           the same, so materials are lost unless someone reads the warning.
# Tried:    usd-core 26.11 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q usd-core==26.11
cat >look.mtlx <<'XML'
<?xml version="1.0"?>
<materialx version="1.38">
  <standard_surface name="S" type="surfaceshader"><input name="base" type="float" value="1"/></standard_surface>
  <surfacematerial name="M" type="material"><input name="surfaceshader" type="surfaceshader" nodename="S"/></surfacematerial>
</materialx>
XML
cat >look.usda <<'USD'
#usda 1.0
def Scope "Looks" (
    references = @./look.mtlx@</MaterialX>
)
{
}
USD
cat >look.py <<'PYTHON'
from pxr import Sdf, Usd

stage = Usd.Stage.Open("look.usda")
children = stage.GetPrimAtPath("/Looks").GetChildren()
extensions = set(Sdf.FileFormat.FindAllFileFormatExtensions())
print("found:", len(children), "children, formats", sorted(extensions))
assert not children and "mtlx" not in extensions and "usda" in extensions
print("held")
PYTHON
venv/bin/python look.py 2>said.txt
grep -q "Could not open asset" said.txt
