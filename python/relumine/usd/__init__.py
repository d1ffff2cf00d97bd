"""USD: stages as scenes, and light back into stages (pip install relumine[usd]).

    asset = relumine.usd.load("teapot.usdz")
    relighter = relumine.Relighter(relumine.precompute(asset.mesh))
    asset.light(relighter)
    relighter.picture().save("teapot.png")
    relumine.usd.save("teapot_lit.usda", asset, relighter)

A stage becomes a glTF file in memory, which the reader of meshes takes: its materials, textures,
lamps and cameras are those that glTF has here, so each property of a material has one way into a
scene, and `relumine relight` takes stages as well. Arrays of vertices alone could not carry them.
"""

from __future__ import annotations

import errno
import os
import tempfile
import warnings as _warnings
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np

try:
    from pxr import Sdf, Tf, Usd, UsdUtils  # type: ignore
except ImportError as error:
    raise ImportError(
        "relumine.usd: expected OpenUSD's Python: pip install relumine[usd]"
    ) from error

from .. import _layers
from .._environment import Environment
from .._files import FileError
from .._mesh import Mesh, RelumineWarning
from ._lights import LEAST_RESOLUTION, Dome, environment_of
from ._mtlx import attach
from ._notes import Notes
from ._stage import Drawn, Reader, bake_skeletons

__all__ = ["Asset", "load", "save"]
Path = Union[str, "os.PathLike[str]"]
FORMATS = (".usd", ".usda", ".usdc", ".usdz")


@dataclass
class Asset:
    """What a stage holds, as scenes have it: metres, +Y up."""

    #: Meshes with their materials, lamps and the camera.
    mesh: Mesh
    #: The sum of the domes; None without any.
    environment: Optional[Environment]
    #: Distant lights, as layers over the environment.
    layers: List[_layers.Layer]
    #: Names of lights that stand in the scene: `emission` of picture() dims them.
    lamps: List[str]
    #: What is left out or assumed, a line each.
    notes: List[str]
    stage: Any = field(repr=False)
    time: Any = field(repr=False)
    _drawn: List[Drawn] = field(repr=False)
    _paths: Dict[str, str] = field(repr=False)
    _domes: List[str] = field(repr=False)

    def light(self, relighter: Any, environment: Optional[Environment] = None) -> None:
        """Lights a scene of the mesh as the stage does, or with an environment of one's own.

        Without a dome it is dark but for distant lights and lamps.
        """
        own = environment or self.environment
        if own is None:
            own = Environment(_dark(), face_resolution=LEAST_RESOLUTION)
        relighter.set_environment(own)
        if environment is None and self.layers:
            relighter.set_layers(self.layers)


def _opened(source: Any) -> Any:
    if isinstance(source, Usd.Stage):
        # Poses go into a session layer, which is not the user's.
        session = Sdf.Layer.CreateAnonymous()
        session.TransferContent(source.GetSessionLayer())
        stage = Usd.Stage.Open(
            source.GetRootLayer(), session, source.GetPathResolverContext(), Usd.Stage.LoadNone
        )
        stage.SetLoadRules(source.GetLoadRules())
        return stage
    path = os.fspath(source)
    if not os.path.exists(path):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
    try:
        return Usd.Stage.Open(path)
    except Tf.ErrorException as error:
        raise FileError(errno.EINVAL, f"expected a stage of USD: {_reason(error)}", path) from None


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= 240 else text[:237] + "..."


def convert(
    source: Any,
    *,
    time: Optional[float] = None,
    purposes: Sequence[str] = ("default", "render"),
    subdivision: int = 2,
    camera: Optional[str] = None,
    lights: bool = True,
) -> Any:
    """A stage as the bytes of a .glb file, and the reader that made it. Options are load()'s."""
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        try:
            return _converted(
                _opened(source), time, purposes, subdivision, camera, lights, delegate
            )
        except Tf.ErrorException as error:
            raise ValueError(f"expected a stage of USD: {_reason(error)}") from None
    finally:
        del delegate


def _reason(error: Any) -> str:
    return _short(error.args[0].commentary) if error.args else "none"


def _converted(
    stage: Any, time: Any, purposes: Any, subdivision: int, camera: Any, lights: bool, delegate: Any
) -> Any:
    if time is not None:
        moment = Usd.TimeCode(float(time))
    elif stage.HasAuthoredTimeCodeRange():
        moment = Usd.TimeCode(stage.GetStartTimeCode())
    else:
        moment = Usd.TimeCode.EarliestTime()
    reader = Reader(stage, moment, purposes, subdivision, camera, lights)
    attach(stage, reader.notes)
    bake_skeletons(stage, moment, reader.notes)
    reader.run()
    data = reader.glb.bytes()
    said = delegate.TakeUncoalescedDiagnostics()
    seen: Dict[str, None] = {}
    for item in said:
        # attach() reads these.
        if ".mtlx@" not in item.commentary:
            seen[_short(item.commentary)] = None
    for text in list(seen)[:20]:
        reader.notes.add(text, "")
    if len(seen) > 20:
        reader.notes.add(f"{len(seen) - 20} more lines of OpenUSD are left out", "")
    return data, reader


def load(
    stage: Any,
    time: Optional[float] = None,
    *,
    purposes: Sequence[str] = ("default", "render"),
    subdivision: int = 2,
    camera: Optional[str] = None,
    lights: bool = True,
    floor: Union[int, str, None] = None,
    floor_scale: float = 4.0,
) -> Asset:
    """Reads a stage: a .usd, .usda, .usdc or .usdz file, or a pxr.Usd.Stage.

    time         the time code; None: the stage's first
    purposes     of default, render, proxy and guide, those that are shown
    subdivision  levels by which subdivision surfaces are refined
    camera       the path of the camera; None: the first one
    lights       False: the stage's lights are left out
    floor, floor_scale  as in Mesh()

    What a scene cannot hold is a RelumineWarning, a line for each kind. Raises OSError with the
    file's name, and ValueError for a stage without meshes or beyond the limits.
    """
    path = "" if isinstance(stage, Usd.Stage) else os.fspath(stage)
    try:
        data, reader = convert(
            stage,
            time=time,
            purposes=purposes,
            subdivision=subdivision,
            camera=camera,
            lights=lights,
        )
    except ValueError as error:
        if path:
            raise FileError(errno.EINVAL, str(error), path) from None
        raise
    if not reader.drawn and not reader.placer.lights.lamps:
        raise FileError(errno.EINVAL, "expected a stage with a mesh, got none", path or "stage")
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "stage.glb")
        with open(name, "wb") as file:
            file.write(data)
        with _warnings.catch_warnings(record=True) as caught:
            _warnings.simplefilter("always")
            mesh = Mesh.load(name, floor=floor, floor_scale=floor_scale)
    mesh._made = _mesh_of, (data, floor, floor_scale), {}
    for item in caught:
        text = str(item.message).replace(name + ": ", "").replace("stage.glb: ", "")
        reader.notes.add(text, "")
    lights_ = reader.placer.lights
    least = LEAST_RESOLUTION if lights_.layers else 16
    environment = environment_of(lights_.domes, _picture(reader.notes), least)
    lines = reader.notes.lines()
    for line in lines:
        _warnings.warn(line, RelumineWarning, stacklevel=2)
    return Asset(
        mesh, environment, lights_.layers, lights_.lamps, lines, reader.stage, reader.time,
        reader.drawn, lights_.paths, [dome.path for dome in lights_.domes],
    )  # fmt: skip


def save(
    path: Path,
    asset: Asset,
    relighter: Any,
    *,
    colors: bool = True,
    lights: bool = True,
    emission: Optional[Mapping[str, Any]] = None,
) -> None:
    """Writes a layer over the asset's stage, which stays as it is: a .usd, .usda or .usdc file.

    relighter  of a scene of asset.mesh
    colors     the light of the vertices as displayColor, with a material that glows as it says
    lights     the relighter's environment as a DomeLight with its .exr beside the layer, and discs
               that emit as DistantLights; those that the stage has keep their prim. Other layers
               become a part of the dome's picture. Domes of the stage become invisible
    emission   {name of a lamp: a number or (r, g, b)}: factors on the lamps' intensity and colour

    Prims of instances become prims of their own.
    """
    from ._write import write

    for line in write(os.fspath(path), asset, relighter, colors, lights, emission or {}):
        _warnings.warn(line, RelumineWarning, stacklevel=2)


def _files(source: str, mesh: str, lights: str) -> List[str]:
    """Writes a stage as a .glb, and its light from afar as an .exr; returns what is said."""
    try:
        data, reader = convert(source)
    except ValueError as error:
        raise FileError(errno.EINVAL, str(error), source) from None
    if not reader.drawn and not reader.placer.lights.lamps:
        raise FileError(errno.EINVAL, "expected a stage with a mesh, got none", source)
    with open(mesh, "wb") as file:
        file.write(data)
    from ._write import under

    found = reader.placer.lights
    least = LEAST_RESOLUTION if found.layers else 16
    environment = environment_of(found.domes, _picture(reader.notes), least)
    if environment is not None or found.layers:
        cube = _dark() if environment is None else np.asarray(environment.cube)
        if found.layers:
            cube = under(cube, found.layers)
        Environment(cube, face_resolution=cube.shape[1]).save(lights, layout="latlong")
    return [f"{source}: {line}" for line in reader.notes.lines()]


def _dark() -> Any:
    return np.zeros((6, LEAST_RESOLUTION, LEAST_RESOLUTION, 3), np.float32)


def _mesh_of(data: bytes, floor: Any, floor_scale: float) -> Mesh:
    """The mesh of a .glb's bytes: what pickles call."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "stage.glb")
        with open(name, "wb") as file:
            file.write(data)
        mesh = Mesh.load(name, floor=floor, floor_scale=floor_scale)
    mesh._made = _mesh_of, (data, floor, floor_scale), {}
    return mesh


def _picture(notes: Notes) -> Any:
    """A function that reads a dome's picture, or says why not."""
    from ._images import Images, read_asset

    layouts = {"latlong": "latlong", "mirroredBall": "mirrorball", "angular": "angular",
               "cubeMapVerticalCross": "cross"}  # fmt: skip

    def load(dome: Dome) -> Optional[Environment]:
        path = dome.texture.resolvedPath
        if not path:
            notes.add(
                f"the dome's picture is not there: {dome.texture.path}; it has one colour",
                dome.name,
            )
            return None
        try:
            data = read_asset(path)
            suffix = os.path.splitext(path.rstrip("]"))[1].lower()
            if suffix not in (".exr", ".hdr"):
                pixels = Images(None, notes).linear(path)  # type: ignore[arg-type]
                if pixels is None:
                    return None
                return Environment(pixels, layout=layouts.get(dome.format), convention="usd")
            with tempfile.TemporaryDirectory() as folder:
                name = os.path.join(folder, "dome" + suffix)
                with open(name, "wb") as file:
                    file.write(data)
                return Environment.load(name, layout=layouts.get(dome.format), convention="usd")
        except (OSError, ValueError) as error:
            words = getattr(error, "strerror", None) or str(error)
            notes.add(f"the dome's picture is left out: {words}; it has one colour", dome.name)
            return None

    return load
