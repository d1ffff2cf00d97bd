"""MaterialX files that a stage refers to, as prims: usd-core opens no .mtlx."""

from __future__ import annotations

import os
from typing import Any, Dict, Optional, Tuple
from xml.etree import ElementTree

from pxr import Gf, Sdf, Usd, UsdShade  # type: ignore

from ._notes import Notes

Element = Any
_TYPES: Dict[str, Tuple[Any, Any]] = {
    "float": (Sdf.ValueTypeNames.Float, None),
    "integer": (Sdf.ValueTypeNames.Int, None),
    "boolean": (Sdf.ValueTypeNames.Bool, None),
    "string": (Sdf.ValueTypeNames.String, None),
    "filename": (Sdf.ValueTypeNames.Asset, None),
    "color3": (Sdf.ValueTypeNames.Color3f, Gf.Vec3f),
    "color4": (Sdf.ValueTypeNames.Color4f, Gf.Vec4f),
    "vector2": (Sdf.ValueTypeNames.Float2, Gf.Vec2f),
    "vector3": (Sdf.ValueTypeNames.Float3, Gf.Vec3f),
    "vector4": (Sdf.ValueTypeNames.Float4, Gf.Vec4f),
}


def attach(stage: Usd.Stage, notes: Notes) -> None:
    """Puts the materials of .mtlx files where prims refer to them, in the session layer."""
    made: Dict[str, Optional[Sdf.Layer]] = {}
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in list(stage.TraverseAll()):
            if not prim.HasAuthoredReferences():
                continue
            for spec in prim.GetPrimStack():
                for reference in spec.referenceList.GetAddedOrExplicitItems():
                    if not reference.assetPath.lower().endswith(".mtlx"):
                        continue
                    path = spec.layer.ComputeAbsolutePath(reference.assetPath)
                    if path not in made:
                        made[path] = _layer(path, notes)
                    layer = made[path]
                    if layer is not None:
                        below = reference.primPath or Sdf.Path("/MaterialX")
                        prim.GetReferences().AddReference(layer.identifier, below)


def _layer(path: str, notes: Notes) -> Optional[Sdf.Layer]:
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        notes.add(f"a file of MaterialX is left out: {error}", path)
        return None
    layer = Sdf.Layer.CreateAnonymous(".usda")
    stage = Usd.Stage.Open(layer)
    stage.DefinePrim("/MaterialX", "Scope")
    stage.DefinePrim("/MaterialX/Materials", "Scope")
    document = _Document(root, os.path.dirname(path), stage)
    for element in root:
        if element.tag == "surfacematerial":
            document.material(element)
    return layer


class _Document:
    def __init__(self, root: Element, folder: str, stage: Usd.Stage) -> None:
        self._root, self._folder, self._stage = root, folder, stage

    def material(self, element: Element) -> None:
        path = Sdf.Path("/MaterialX/Materials").AppendChild(_name(element.get("name", "")))
        material = UsdShade.Material.Define(self._stage, path)
        self._nodes: Dict[Tuple[Any, str], UsdShade.Shader] = {}
        for given in element:
            shader = self._found(self._root, given.get("nodename", ""))
            if given.get("name") == "surfaceshader" and shader is not None:
                output = self._node(path, self._root, shader, 0).CreateOutput(
                    "out", Sdf.ValueTypeNames.Token
                )
                material.CreateSurfaceOutput("mtlx").ConnectToSource(output)

    @staticmethod
    def _found(scope: Element, name: str) -> Optional[Element]:
        return next((e for e in scope if name and e.get("name") == name), None)

    def _node(
        self, material: Sdf.Path, scope: Element, element: Element, depth: int
    ) -> UsdShade.Shader:
        name = _name(element.get("name", ""))
        if scope is not self._root:
            name = f"{_name(scope.get('name', ''))}_{name}"
        key = (scope, name)
        if key in self._nodes:
            return self._nodes[key]
        shader = UsdShade.Shader.Define(self._stage, material.AppendChild(name))
        self._nodes[key] = shader
        shader.CreateIdAttr(f"ND_{element.tag}_{element.get('type', '')}")
        for given in element:
            if given.tag == "input" and depth < 32:
                self._input(material, scope, shader, given.get("name", ""), given, depth)
        return shader

    def _input(
        self, material: Sdf.Path, scope: Element, shader: Any, name: str, given: Element, depth: int
    ) -> None:
        kind, vector = _TYPES.get(given.get("type", ""), (Sdf.ValueTypeNames.Token, None))
        through = given.get("interfacename")
        if through is not None and scope is not self._root:
            inner = self._found(scope, through)
            if inner is not None:
                self._input(material, self._root, shader, name, inner, depth)
            return
        result = shader.CreateInput(_name(name), kind)
        source_scope, source = scope, given.get("nodename")
        output = given.get("output") or "out"
        graph = self._found(self._root, given.get("nodegraph", ""))
        if graph is not None:
            outputs = [e for e in graph if e.tag == "output"]
            named = next((e for e in outputs if e.get("name") == given.get("output")), None)
            end = named if named is not None else (outputs[0] if outputs else None)
            if end is None:
                return
            source_scope, source, output = graph, end.get("nodename"), end.get("output") or "out"
        node = self._found(source_scope, source or "")
        if node is not None:
            made = self._node(material, source_scope, node, depth + 1)
            result.ConnectToSource(made.CreateOutput(_name(output), kind))
            return
        text = given.get("value")
        if text is None:
            return
        value = _value(text, given.get("type", ""), vector)
        if given.get("type") == "filename":
            scopes = [self._root] if scope is self._root else [self._root, scope]
            prefix = "".join(e.get("fileprefix", "") for e in scopes)
            value = Sdf.AssetPath(os.path.join(self._folder, prefix + text))
            space = (
                given.get("colorspace") or scope.get("colorspace") or self._root.get("colorspace")
            )
            if space:
                result.GetAttr().SetColorSpace(space)
        if value is not None:
            result.Set(value)


def _name(text: str) -> str:
    plain = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in text)
    return plain if plain and not plain[0].isdigit() else f"_{plain}"


def _value(text: str, kind: str, vector: Any) -> Any:
    try:
        if kind == "boolean":
            return text.strip() == "true"
        if kind == "integer":
            return int(text)
        if kind == "float":
            return float(text)
        if vector is not None:
            return vector(*(float(x) for x in text.split(",")))
    except (ValueError, TypeError):
        return None
    return text
