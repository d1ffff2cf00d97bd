#!/usr/bin/env bash
# MaterialX (standard_surface to glTF and USD): a dark lacquer loses its highlight, and in USD glass is opaque.
#
# Expected: coat_color tints what lies below the coat, while the coat itself mirrors white: a smoked varnish of 0.1 0.1 0.1 is a
#           clear coat of weight 1 over a dark base. Glass, transmission 1, gets an opacity of 0 in UsdPreviewSurface.
# Found:    the weight is multiplied by the mean of coat_color: 0.1, a tenth of the highlight, and 0.067 for red of 0.2 0 0. The
#           base is darkened as well. UsdPreviewSurface has opacity 1 for glass, since transmission is no input of the
#           translation; nothing is said.
# Tried:    MaterialX 1.39.5 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q MaterialX==1.39.5 numpy==2.4.6
cat >coat.py <<'PYTHON'
import MaterialX as mx
import numpy as np
from MaterialX import PyMaterialXGenShader as gen

library = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)


def plain(value):
    return np.array(list(value), float) if hasattr(value, "__iter__") else value


def value(graph, node, inputs):
    """What a node of a translation gives, for numbers of the material."""
    def of(name):
        port = node.getActiveInput(name)
        if port.getInterfaceName():
            return inputs[port.getInterfaceName()]
        return value(graph, graph.getNode(port.getNodeName()), inputs) if port.getNodeName() else plain(port.getValue())
    kinds = {"mix": lambda: of("fg") * of("mix") + of("bg") * (1 - of("mix")), "dot": lambda: of("in"),
             "multiply": lambda: of("in1") * of("in2"), "divide": lambda: of("in1") / of("in2"),
             "dotproduct": lambda: float(np.dot(of("in1"), of("in2"))),
             "convert": lambda: of("in") * np.ones(3), "ifequal": lambda: of("in1") if of("value1") == of("value2") else of("in2")}
    return kinds[node.getCategory()]()


def translated(target, names, **settings):
    """Inputs of the surface that a standard_surface becomes."""
    document = mx.createDocument()
    document.importLibrary(library)
    shader = document.addNode("standard_surface", "lacquered", "surfaceshader")
    for name, setting in settings.items():
        color = isinstance(setting, tuple)
        shader.setInputValue(name, mx.Color3(*setting) if color else setting, "color3" if color else "float")
    document.addMaterialNode("look", shader)
    gen.ShaderTranslator.create().translateAllMaterials(document, target)
    (surface,) = document.getNodes(target)
    node = surface.getInput(names[0]).getConnectedNode()
    definition = node.getNodeDef()
    graph = definition.getImplementation()
    given = {port.getName(): plain(port.getValue()) for port in definition.getInputs()}
    given.update({port.getName(): plain(port.getValue()) for port in node.getInputs()})
    return [np.round(value(graph, graph.getNode(graph.getOutput(surface.getInput(name).getOutputString()).getNodeName()), given), 4)
            for name in names]


weights = {}
for target, name in (("gltf_pbr", "clearcoat"), ("UsdPreviewSurface", "clearcoat")):
    for color in ((1.0, 1.0, 1.0), (0.1, 0.1, 0.1), (0.2, 0.0, 0.0)):
        weights[target, color] = float(translated(target, [name], coat=1.0, coat_color=color)[0])
print("found: weight of a coat of weight 1", weights)
opacity = float(translated("UsdPreviewSurface", ["opacity"], transmission=1.0, base=0.0)[0])
print("found: opacity of glass in USD", opacity)
for target in ("gltf_pbr", "UsdPreviewSurface"):
    assert abs(weights[target, (1.0, 1.0, 1.0)] - 1) < 0.001 and abs(weights[target, (0.1, 0.1, 0.1)] - 0.1) < 0.001
    assert abs(weights[target, (0.2, 0.0, 0.0)] - 0.2 / 3) < 0.001
assert opacity == 1
PYTHON
venv/bin/python coat.py
