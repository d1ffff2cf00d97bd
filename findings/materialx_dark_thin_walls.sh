#!/usr/bin/env bash
# MaterialX (OpenPBR, thin walls): the colour of a leaf counts twice.
#
# Expected: with geometry_thin_walled and subsurface_weight 1, OpenPBR 1.1 has diffuse lobes of albedo 1, reflection and
#           transmission by (1 - g) / 2 and (1 + g) / 2, times subsurface_color once: grey of 0.5 leaves half of a white room's
#           light, a quarter on each side.
# Found:    the graph gives each lobe subsurface_color and multiplies by it once more. Grey of 0.5 leaves a quarter, an eighth
#           on each side; leaves and paper are darker and more saturated than the colour that was chosen.
# Tried:    MaterialX 1.39.5 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q MaterialX==1.39.5
cat >thin.py <<'PYTHON'
import MaterialX as mx

library = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
graph = library.getNodeDef("ND_open_pbr_surface_surfaceshader").getImplementation()
inputs = {"subsurface_color": 0.5, "subsurface_scatter_anisotropy": 0.0}


def value(node_name):
    """A grey number of the graph."""
    node = graph.getNode(node_name)
    def of(name):
        port = node.getInput(name)
        if port.getNodeName():
            return value(port.getNodeName())
        if port.getInterfaceName():
            return inputs[port.getInterfaceName()]
        given = port.getValue()
        return given[0] if hasattr(given, "__len__") or hasattr(given, "asTuple") else float(given)
    kind = node.getCategory()
    if kind.endswith("_bsdf"):  # the albedo of a Lambertian lobe
        return of("color")
    return {"multiply": lambda: of("in1") * of("in2"), "add": lambda: of("in1") + of("in2"),
            "subtract": lambda: of("in1") - of("in2"), "max": lambda: max(of("in1"), of("in2")),
            "mix": lambda: of("bg") * (1 - of("mix")) + of("fg") * of("mix")}[kind]()


reflected, passed = value("subsurface_thin_walled_reflection") / 2, value("subsurface_thin_walled_transmission") / 2
print(f"found: of white light a sheet of subsurface_color 0.5 reflects {reflected} and passes on {passed}")
assert abs(value("subsurface_thin_walled") - (reflected + passed)) < 1e-9
assert abs(reflected + passed - 0.25) < 1e-9, "0.5 is what the specification says"
print("held")
PYTHON
venv/bin/python thin.py
