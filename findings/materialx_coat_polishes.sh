#!/usr/bin/env bash
# MaterialX (OpenPBR to standard_surface): under a smooth coat the surface gets as smooth as the coat.
#
# Expected: specular_roughness stays, since both models have a roughness of the coat beside that of the surface, or grows
#           with the coat's, as rough lacquer blurs what is below.
# Found:    it is mixed with coat_roughness by coat_weight: brushed metal of 0.6 under a smooth coat becomes a mirror of
#           roughness 0, 0.3 under half a coat. The coat itself is translated beside it.
# Tried:    MaterialX 1.39.5 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q MaterialX==1.39.5
cat >coat.py <<'PYTHON'
import MaterialX as mx
from MaterialX import PyMaterialXGenShader as gen

library = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)


def value(graph, node, inputs):
    """A number of a translation's node graph, for numbers of the material."""
    def of(name):
        port = node.getActiveInput(name)
        if port.getInterfaceName():
            return inputs[port.getInterfaceName()]
        return value(graph, graph.getNode(port.getNodeName()), inputs) if port.getNodeName() else port.getValue()
    kinds = {"mix": lambda: of("fg") * of("mix") + of("bg") * (1 - of("mix")), "dot": lambda: of("in")}
    return kinds[node.getCategory()]()


def translated(**numbers):
    """(roughness of the surface, weight and roughness of the coat) in standard_surface."""
    document = mx.createDocument()
    document.importLibrary(library)
    shader = document.addNode("open_pbr_surface", "lacquered", "surfaceshader")
    for name, number in numbers.items():
        shader.setInputValue(name, number, "float")
    document.addMaterialNode("look", shader)
    gen.ShaderTranslator.create().translateAllMaterials(document, "standard_surface")
    (surface,) = document.getNodes("standard_surface")
    inputs = [surface.getInput(name) for name in ("specular_roughness", "coat", "coat_roughness")]
    node = inputs[0].getConnectedNode()
    graph = node.getNodeDef().getImplementation()
    given = {port.getName(): port.getValue() for port in node.getInputs()}
    outputs = [graph.getOutput(port.getOutputString()).getNodeName() for port in inputs]
    return tuple(round(value(graph, graph.getNode(name), given), 6) for name in outputs)


found = {weight: translated(base_metalness=1.0, specular_roughness=0.6, coat_weight=weight, coat_roughness=0.0)
         for weight in (0.0, 0.5, 1.0)}
print("found, roughness and coat:", found)
assert all(abs(found[weight][0] - 0.6 * (1 - weight)) < 1e-5 for weight in found)
assert found[1.0][1:] == (1.0, 0.0)
PYTHON
venv/bin/python coat.py
