"""Environments."""

from __future__ import annotations

import os
from typing import Any, Dict, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, doubles, floats, view, whole, word
from ._files import Path, errors
from ._lights import LightList
from ._mesh import warn
from ._picture import Picture


class Environment:
    """Measured light from all directions, ready to light any scene. It never changes.

    pixels    (H, 2 H, 3): a lat-long. (6, R, R, 3): the cube faces +X -X +Y -Y +Z -Z. Any other
              (H, W, 3) with `layout`. Linear RGB radiance; bytes of a screen are refused, and alpha,
              a fourth channel, is left out with a warning.
    layout    latlong, cube, strip, cross, hcross, angular, mirrorball or octahedral
    convention  whose axes the picture has: openexr, usd, mitsuba, blender, threejs, babylonjs,
              opengl, directx, pbrt, pbrt-v2
    face_resolution  R of the cube map that it becomes; 0: as fine as the picture, and finer where
              single pixels hold much of the light
    fix_env   replaces NaN and negative radiance by 0, infinite by the largest finite; otherwise
              they are refused
    flip      mirrors along an axis of the world, "x", "y" or "z"; first
    tilt      turns about +X, degrees: light from +Y comes from +Z at 90; second
    rotate    turns about +Y, degrees: light from +Z comes from +X at 90; last

    The world is right-handed with +Y up. The middle of a lat-long is +Z, and +X is left of it.

    >>> relumine.Environment(np.full((32, 64, 3), 0.5), rotate=90)
    <relumine.Environment: latlong 64 x 32, lights as 6 x 16 x 16, rotate 90>
    """

    def __init__(
        self,
        pixels: ArrayLike,
        *,
        layout: Optional[str] = None,
        convention: str = "openexr",
        face_resolution: int = 0,
        fix_env: bool = False,
        flip: Optional[str] = None,
        tilt: float = 0.0,
        rotate: float = 0.0,
    ) -> None:
        options = _options(layout, convention, face_resolution, fix_env, flip, tilt, rotate)
        pixels = _radiance(pixels)
        if np.ndim(pixels) == 4:
            side = np.shape(pixels)[1]
            array = floats("pixels", pixels, 6, side, side, 3, finite=False)
            array = array.reshape(6 * side, side, 3)
            options["layout"] = "cube"
        else:
            array = floats("pixels", pixels, None, None, 3, finite=False)
        height, width, _ = array.shape
        with errors():
            core = _core.environment_from_pixels(array, width, height, options)
        warn(core.warnings)
        self._core = core

    @classmethod
    def load(
        cls,
        path: Path,
        *,
        layout: Optional[str] = None,
        convention: str = "openexr",
        face_resolution: int = 0,
        fix_env: bool = False,
        flip: Optional[str] = None,
        tilt: float = 0.0,
        rotate: float = 0.0,
    ) -> "Environment":
        """Reads an environment's file, or six where the name has {face} (px nx py ny pz nz).

        .exr, .hdr, .tif, .pfm, .dds, .ktx2, or .jpg with a gain map.

        Raises OSError with the file's name.

        >>> relumine.Environment.load("sky.exr").layout
        'latlong'
        """
        options = _options(layout, convention, face_resolution, fix_env, flip, tilt, rotate)
        with errors(path):
            core = _core.load_environment(os.fspath(path), options)
        warn(core.warnings)
        return cls._of(core)

    @classmethod
    def _of(cls, core: _core.Environment) -> "Environment":
        environment = cls.__new__(cls)
        environment._core = core
        return environment

    def __reduce__(self) -> Any:
        return _environment_from, (np.array(self.pixels), self._core.state())

    def __deepcopy__(self, memo: Any) -> "Environment":
        return self

    def turned(
        self,
        *,
        flip: Optional[str] = None,
        tilt: float = 0.0,
        rotate: float = 0.0,
        turn: Optional[ArrayLike] = None,
        face_resolution: Optional[int] = None,
    ) -> "Environment":
        """The same picture with other angles, counted from the picture, not from these.

        turn  (3, 3): a rotation about any axis, which takes directions of the picture to those of
              the world; after flip, tilt and rotate
        """
        matrix = doubles("turn", np.eye(3) if turn is None else turn, 3, 3)
        if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-5:
            raise ValueError("turn: expected the matrix of a rotation, which keeps lengths")
        resolution = self.face_resolution if face_resolution is None else face_resolution
        options = {"flip": flip, "tilt": tilt, "rotate": rotate, "face_resolution": resolution}
        return Environment._of(self._core.turned(options, [[float(x) for x in row] for row in matrix]))

    @property
    def cube(self) -> Floats:
        """(6, R, R, 3) float32, read-only: what lights a scene, in the world's axes."""
        result: Floats = view(self._core.cube)
        return result

    @property
    def pixels(self) -> Floats:
        """(H, W, 3) float32, read-only: the picture as it is in the file."""
        result: Floats = view(self._core.pixels)
        return result

    @property
    def layout(self) -> str:
        """The layout of `pixels`."""
        return self._core.layout

    @property
    def assumptions(self) -> str:
        """Which layout and sampling the file has, and why: one sentence."""
        return self._core.assumptions

    @property
    def face_resolution(self) -> int:
        """R of `cube`."""
        return self._core.face_resolution

    def irradiance(self, normal: Sequence[float]) -> Tuple[float, float, float]:
        """RGB irradiance of an unshadowed surface with a normal (x, y, z)."""
        n = np.asarray(normal, dtype=np.float64)
        length = float(np.linalg.norm(n)) if n.shape == (3,) else 0.0
        if not 0.0 < length < np.inf:
            raise ValueError(f"normal: expected a vector (x, y, z), got {normal}")
        x, y, z = (float(v) for v in n / length)
        return _core.irradiance(self._core, (x, y, z))

    def convert(
        self,
        *,
        layout: Optional[str] = None,
        to: str = "openexr",
        size: Optional[Tuple[int, int]] = None,
        face_resolution: Optional[int] = None,
    ) -> Floats:
        """The picture, turned, in another layout and convention: (H, W, 3) float32.

        size             (width, height)
        face_resolution  the same as the resolution of a cube face

        The energy of every pixel is kept.

        >>> environment.convert(layout="cube", face_resolution=16).shape
        (96, 16, 3)
        """
        options = {"layout": layout, "to": to, "size": size, "face_resolution": face_resolution}
        with errors():
            array, _ = _core.convert_to_array(self._core, options)
        result: Floats = view(array)
        return result

    def save(
        self,
        path: Path,
        *,
        layout: Optional[str] = None,
        to: str = "openexr",
        size: Optional[Tuple[int, int]] = None,
        face_resolution: Optional[int] = None,
    ) -> None:
        """Writes what convert() returns as .exr or .hdr; six files where the name has {face}."""
        options = {"layout": layout, "to": to, "size": size, "face_resolution": face_resolution}
        with errors(path):
            _core.convert_to_file(os.fspath(path), self._core, options)

    def doctor(self) -> Dict[str, Any]:
        """Figures and faults: the sun, a clipped sun, seams; the fields of `relumine info --json`.

        Directions are in the world's axes.

        >>> environment.doctor()["sun"]["diameter_degrees"]  # doctest: +SKIP
        0.53
        """
        return self._core.findings()

    def without_sun(self) -> Tuple["Environment", LightList]:
        """The sky around the sun in its place, and the sun as a list of one light.

        Raises ValueError with the reason where there is no sun.
        """
        split = self._core.without_sun()
        if isinstance(split, str):
            raise ValueError(f"environment: expected a sun, got none: {split}")
        core, direction, irradiance, solid_angle = split
        return Environment._of(core), LightList([direction], [irradiance], [solid_angle])

    def place_lights(
        self, number: int = 64, *, method: str = "variance", seed: int = 1
    ) -> LightList:
        """A few distant lights that stand for the environment; their energy is the map's.

        method  "median-cut" (Debevec), "variance" (Viriyothai and Debevec) or "importance"

        >>> len(environment.place_lights(16, method="median-cut"))
        16
        """
        w, e, a = _core.place_lights(
            self._core,
            whole("number", number, 1),
            word("method", method),
            whole("seed", seed, most=2**64 - 1),
        )
        return LightList(view(w), view(e), view(a), method=method)

    def median_cut(self, number: int = 64) -> LightList:
        """place_lights() by median cut: regions of equal energy."""
        return self.place_lights(number, method="median-cut")

    def _repr_png_(self) -> bytes:
        pixels = self.convert(layout="latlong", size=(512, 256))
        bright = float(np.quantile(pixels.max(axis=2), 0.9))
        exposure = -np.log2(bright) if bright > 0.0 else 0.0
        return Picture(pixels, exposure=float(exposure)).png()

    def __repr__(self) -> str:
        height, width, _ = self.pixels.shape
        flip, tilt, rotate = self._core.angles
        turns = [f"flip {flip}"] if flip else []
        angles = (("tilt", tilt), ("rotate", rotate))
        turns += [f"{name} {angle:g}" for name, angle in angles if angle]
        r = self.face_resolution
        return (
            f"<relumine.Environment: {self.layout} {width} x {height}, "
            f"lights as 6 x {r} x {r}{''.join(', ' + turn for turn in turns)}>"
        )


def _radiance(pixels: ArrayLike) -> ArrayLike:
    """Pixels without alpha. Refuses those of a screen, whose numbers are no radiance."""
    kind = getattr(pixels, "dtype", None)
    if kind in (np.uint8, np.uint16):
        raise ValueError(
            f"pixels: expected linear radiance, got {kind} as screens have it: "
            f"(pixels / {np.iinfo(kind).max}) ** 2.2 is nearly what it shows"
        )
    if np.ndim(pixels) in (3, 4) and np.shape(pixels)[-1] == 4:
        warn(["pixels: expected red, green and blue, got a fourth channel, which is left out"])
        pixels = np.asarray(pixels)[..., :3]
    return pixels


def _options(
    layout: Optional[str],
    convention: str,
    face_resolution: int,
    fix_env: bool,
    flip: Optional[str],
    tilt: float,
    rotate: float,
) -> Dict[str, Any]:
    return {
        "layout": layout,
        "from": convention,
        "face_resolution": face_resolution,
        "fix_env": fix_env,
        "flip": flip,
        "tilt": tilt,
        "rotate": rotate,
    }


def _environment_from(pixels: Floats, state: Tuple[Any, ...]) -> Environment:
    """The environment of a picture: what pickles call."""
    return Environment._of(_core.environment_from_state(pixels, state))
