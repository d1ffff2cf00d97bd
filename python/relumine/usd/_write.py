"""Light back into a stage: a layer over it."""

from __future__ import annotations

import errno
import math
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt  # type: ignore

from .. import _relighter
from .._arrays import view
from .._environment import Environment
from .._files import FileError
from .._layers import SHAPES, Emit, Layer
from .._scene import precompute

Array = NDArray[Any]
Gain = Union[float, Sequence[float]]
#: Where the layer keeps what is new.
ROOT = "/Relumine"


def write(
    path: str, asset: Any, relighter: Any, colors: bool, lights: bool, emission: Mapping[str, Gain]
) -> List[str]:
    """Returns lines on what is left out."""
    writer = _Writer(path, asset)
    if colors:
        writer.colors(np.asarray(relighter.radiance))
    if lights:
        writer.lights(relighter)
    writer.emission(emission)
    writer.save()
    return writer.lines


class _Writer:
    def __init__(self, path: str, asset: Any) -> None:
        if not path.lower().endswith((".usd", ".usda", ".usdc")):
            raise FileError(errno.EINVAL, "expected a name that ends in .usd, .usda or .usdc", path)
        below: Sdf.Layer = asset.stage.GetRootLayer()
        if not below.anonymous and os.path.abspath(below.realPath) == os.path.abspath(path):
            raise FileError(errno.EINVAL, "expected another file than the stage itself", path)
        self._path, self._asset = path, asset
        self.lines: List[str] = []
        self.layer = Sdf.Layer.CreateAnonymous(os.path.basename(path))
        folder = os.path.dirname(os.path.abspath(path))
        #: Memory has no name: such a stage is written whole.
        self._whole = below.anonymous
        if self._whole:
            self.layer.TransferContent(asset.stage.Flatten())
        else:
            # Relative to the folder, which a layer in memory does not have yet.
            relative = os.path.relpath(below.realPath, folder)
            self._below = relative if relative.startswith("..") else f"./{relative}"
            self.layer.subLayerPaths.append(below.realPath)
        self.stage = Usd.Stage.Open(self.layer, asset.stage.GetPathResolverContext())
        source = asset.stage
        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.GetStageUpAxis(source))
        UsdGeom.SetStageMetersPerUnit(self.stage, UsdGeom.GetStageMetersPerUnit(source))
        if source.HasDefaultPrim():
            self.stage.SetDefaultPrim(self.stage.GetPrimAtPath(source.GetDefaultPrim().GetPath()))
        if source.HasAuthoredTimeCodeRange():
            self.stage.SetStartTimeCode(source.GetStartTimeCode())
            self.stage.SetEndTimeCode(source.GetEndTimeCode())
        #: (3, 3) columns: the stage's axes of the world's.
        self._axes = np.eye(3)
        if UsdGeom.GetStageUpAxis(source) == "Z":
            self._axes = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])

    def save(self) -> None:
        del self.stage  # which would look for the name below
        if not self._whole:
            self.layer.subLayerPaths[0] = self._below
        folder = os.path.dirname(os.path.abspath(self._path))
        if not os.path.isdir(folder):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), self._path)
        name, extension = os.path.splitext(self._path)
        temporary = f"{name}.{os.getpid()}.part{extension}"
        try:
            if not self.layer.Export(temporary):
                raise FileError(errno.EIO, "could not be written", self._path)
            os.replace(temporary, self._path)
        finally:
            if os.path.exists(temporary):
                os.remove(temporary)

    # What the surfaces send out.

    def _own(self, path: str) -> Usd.Prim:
        """The prim, of its own: an instance that shows it stops being one."""
        for above in Sdf.Path(path).GetPrefixes():
            prim = self.stage.GetPrimAtPath(above)
            if prim and prim.IsInstance():
                prim.SetInstanceable(False)
        return self.stage.GetPrimAtPath(path)

    def colors(self, radiance: Array) -> None:
        count = len(self._asset.mesh.vertices)
        if len(radiance) < count:
            raise ValueError(
                f"relighter: expected the light of {count} vertices of the asset's mesh, got "
                f"{len(radiance)} receivers"
            )
        by_path: Dict[str, List[Any]] = {}
        left_out: Dict[str, None] = {}
        for drawn in self._asset._drawn:
            if drawn.is_own:
                by_path.setdefault(drawn.path, []).append(drawn)
            else:
                left_out[drawn.path] = None
        look = self._lit_look()
        for path, parts in by_path.items():
            prim = self._own(path)
            if not prim or not prim.IsA(UsdGeom.Mesh):
                left_out[path] = None
                continue
            self._color(prim, parts, radiance)
            binding = UsdShade.MaterialBindingAPI.Apply(prim)
            binding.Bind(look, UsdShade.Tokens.strongerThanDescendants)
        if left_out:
            self.lines.append(
                f"{next(iter(left_out))}{f' and {len(left_out) - 1} more' * (len(left_out) > 1)}: "
                "instances of point instancers, and shapes, have no colours of their own"
            )

    def _color(self, prim: Usd.Prim, parts: List[Any], radiance: Array) -> None:
        mesh = UsdGeom.Mesh(prim)
        is_refined = parts[0].is_refined
        counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get(self._asset.time))
        size = parts[0].num_points if is_refined else int(counts.sum())
        total, number = np.zeros((size, 3)), np.zeros(size)
        if is_refined:
            for part in parts:
                point = part.shown.of_file
                rows = radiance[part.first : part.first + part.shown.size][point >= 0]
                np.add.at(total, point[point >= 0], rows)
                number += np.bincount(point[point >= 0], minlength=size)
        else:
            for part in parts:
                vertex = part.shown.of_file
                shown = vertex >= 0
                total[shown] = radiance[part.first + vertex[shown]]
                number[shown] = 1
        values = total / np.maximum(number, 1)[:, None]
        kind = UsdGeom.Tokens.vertex if is_refined else UsdGeom.Tokens.faceVarying
        api = UsdGeom.PrimvarsAPI(prim)
        color = api.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, kind)
        color.GetAttr().Block()  # whatever the stage has, at all times
        color.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, np.float32)))
        color.SetInterpolation(kind)
        if color.IsIndexed() or color.GetIndicesAttr():
            color.BlockIndices()

    def _lit_look(self) -> UsdShade.Material:
        """A material that glows as displayColor says and reflects nothing."""
        path = Sdf.Path(f"{ROOT}/Lit")
        UsdGeom.Scope.Define(self.stage, ROOT)
        material = UsdShade.Material.Define(self.stage, path)
        reader = UsdShade.Shader.Define(self.stage, path.AppendChild("displayColor"))
        reader.CreateIdAttr("UsdPrimvarReader_float3")
        reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
        output = reader.CreateOutput("result", Sdf.ValueTypeNames.Float3)
        surface = UsdShade.Shader.Define(self.stage, path.AppendChild("surface"))
        surface.CreateIdAttr("UsdPreviewSurface")
        black = Gf.Vec3f(0.0)
        surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(black)
        surface.CreateInput("useSpecularWorkflow", Sdf.ValueTypeNames.Int).Set(1)
        surface.CreateInput("specularColor", Sdf.ValueTypeNames.Color3f).Set(black)
        glow = surface.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
        glow.ConnectToSource(output)
        shown = surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        material.CreateSurfaceOutput().ConnectToSource(shown)
        return material

    # What lights them.

    def lights(self, relighter: Any) -> None:
        base, degrees = relighter._core.base()
        cube = np.array(view(base))
        layers = [layer for layer in relighter.layers if layer.on]
        if any(layer.solo for layer in layers):
            layers = [layer for layer in layers if layer.solo]
            cube[:] = 0.0
        # A layer under one that is no light is part of the picture.
        baked = max((i + 1 for i, layer in enumerate(layers) if not _is_light(layer)), default=0)
        if baked:
            cube = under(cube, layers[:baked])
        self._dome(Environment(cube, face_resolution=cube.shape[1]).turned(rotate=degrees))
        known = self._asset._paths
        for layer in layers[baked:]:
            if degrees == 0.0 and layer in self._asset.layers:
                continue
            self._distant(layer, degrees, known.get(layer.name))
        still = {layer.name for layer in layers[baked:]}
        for layer in self._asset.layers:
            if layer.name not in still:
                self._hide(known[layer.name])

    def _hide(self, path: str) -> None:
        prim = self._own(path)
        if prim:
            UsdGeom.Imageable(prim).CreateVisibilityAttr().Set(UsdGeom.Tokens.invisible)

    def _dome(self, environment: Environment) -> None:
        for path in self._asset._domes:
            self._hide(path)
        if not np.asarray(environment.cube).any():
            return
        name = os.path.splitext(self._path)[0] + "_dome.exr"
        environment.save(name, layout="latlong", to="usd")
        UsdGeom.Scope.Define(self.stage, ROOT)
        dome = UsdLux.DomeLight.Define(self.stage, f"{ROOT}/Dome")
        dome.CreateTextureFileAttr(f"./{os.path.basename(name)}")
        dome.CreateTextureFormatAttr(UsdLux.Tokens.latlong)
        self._turn(dome.GetPrim(), self._axes)

    @staticmethod
    def _turn(prim: Usd.Prim, columns: Array) -> None:
        matrix = np.eye(4)
        matrix[:3, :3] = columns.T
        transform = UsdGeom.Xformable(prim).MakeMatrixXform()
        transform.Set(Gf.Matrix4d(matrix.tolist()))

    def _distant(self, layer: Layer, degrees: float, path: Optional[str]) -> None:
        color = np.asarray(getattr(layer.effect, "radiance"), float)
        if layer.kelvin:
            color = color * _kelvin_color(layer.kelvin)
        strength = max(float(color.max()), 1e-30)
        if path is None:
            UsdGeom.Scope.Define(self.stage, ROOT)
            path = f"{ROOT}/{_identifier(self.stage, layer.name)}"
            light = UsdLux.DistantLight.Define(self.stage, path)
            light.GetPrim().SetDisplayName(layer.name)
        else:
            light = UsdLux.DistantLight(self._own(path))
        light.CreateAngleAttr(2.0 * layer.region.radius_degrees)
        light.CreateColorAttr(Gf.Vec3f(*(float(x) for x in color / strength)))
        light.CreateEnableColorTemperatureAttr(False)
        light.CreateIntensityAttr(strength)
        light.CreateExposureAttr(float(layer.gain_ev))
        light.CreateNormalizeAttr(False)
        angle = math.radians(degrees)
        turn = np.array([[math.cos(angle), 0, math.sin(angle)], [0, 1, 0],
                         [-math.sin(angle), 0, math.cos(angle)]])  # fmt: skip
        back = turn @ np.asarray(layer.region.direction, float)
        back /= np.linalg.norm(back)
        up = np.eye(3)[1 if abs(back[1]) < 0.99 else 2]
        right = np.cross(up, back)
        right /= np.linalg.norm(right)
        frame = self._axes @ np.stack([right, np.cross(back, right), back], 1)
        prim = light.GetPrim()
        above = UsdGeom.XformCache(self._asset.time).GetParentToWorldTransform(prim)
        local = np.eye(4)
        local[:3, :3] = frame.T
        local = local @ np.linalg.inv(np.array(above))
        UsdGeom.Xformable(prim).MakeMatrixXform().Set(Gf.Matrix4d(local.tolist()))

    def emission(self, gains: Mapping[str, Gain]) -> None:
        """Factors on lamps, as picture() takes them."""
        for name, gain in gains.items():
            if name not in self._asset.lamps:
                raise ValueError(
                    f"emission: expected a lamp ({', '.join(self._asset.lamps)}), got {name}"
                )
            factor = np.broadcast_to(np.asarray(gain, float), (3,))
            if not (np.isfinite(factor).all() and (factor >= 0.0).all()):
                raise ValueError(
                    f"emission: expected a number or (r, g, b) of 0 or more, got {gain}"
                )
            prim = self._own(self._asset._paths[name])
            light, time = UsdLux.LightAPI(prim), self._asset.time
            strength = max(float(factor.max()), 1e-30)
            light.CreateIntensityAttr().Set(float(light.GetIntensityAttr().Get(time)) * strength)
            color = np.asarray(light.GetColorAttr().Get(time), float) * (factor / strength)
            light.CreateColorAttr().Set(Gf.Vec3f(*(float(x) for x in color)))


def _is_light(layer: Layer) -> bool:
    region = layer.region
    return layer.effect.effect == "emit" and region.type == "disc" and region.softness == 0.0


def under(cube: Array, layers: List[Layer]) -> Array:
    """A cube with layers over it. A scene of one triangle carries them."""
    scene = precompute([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], refine=False, tolerance=0.3)
    relighter = _relighter.Relighter(scene)
    relighter.set_environment(Environment(cube, face_resolution=cube.shape[1]))
    relighter.set_layers(layers)
    return np.array(relighter.environment)


def _kelvin_color(kelvin: float) -> Array:
    """The colour of a layer's kelvin."""
    everywhere = Layer(
        "", SHAPES["Disc"]((0.0, 1.0, 0.0), 180.0), Emit((1.0, 1.0, 1.0)), kelvin=kelvin
    )
    return np.asarray(under(np.zeros((6, 4, 4, 3), np.float32), [everywhere])[0, 0, 0], float)


def _identifier(stage: Usd.Stage, name: str) -> str:
    first = Sdf.Path.StripPrefixNamespace(name, "")[0] or "light"
    plain = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in first)
    plain = plain if plain[:1].isalpha() or plain[:1] == "_" else f"_{plain}"
    result, count = plain, 1
    while stage.GetPrimAtPath(f"{ROOT}/{result}"):
        count += 1
        result = f"{plain}_{count}"
    return result
