"""Profiles of lamps: what UsdLux's ShapingAPI makes of a file, as a file of its own.

glTF's lights with profiles are points. So the cosine of a flat light and its cone are parts of the
profile.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .. import _core

Array = NDArray[Any]
#: Beyond the last angle of a profile there is no light: it ends within so many degrees.
_EDGE = 1e-3


@dataclass(frozen=True)
class Shape:
    """What is made of a file's intensities.

    angle_scale  as UsdLux has it
    normalize    divides by the mean intensity: over all directions, or over half of them where the
                 file has no more
    is_flat      a surface that looks along the axis: times the cosine
    cone         the inner and the outer half angle in degrees
    """

    angle_scale: float
    normalize: bool
    is_flat: bool
    cone: Optional[Tuple[float, float]]


def shaped(file: bytes, shape: Shape) -> Tuple[bytes, List[str]]:
    """A file of LM-63 with factors on a light's intensity, and what is left out of the given one.

    Raises RuntimeError for a file that cannot be read.
    """
    vertical, horizontal, candela, flux, left_out = _core.light_profile(file)
    v, h = np.asarray(vertical, float), np.asarray(horizontal, float)
    rows = np.asarray(candela, float)
    scale = shape.angle_scale
    to_file: Callable[[Array], Array] = lambda a: a
    from_file = to_file
    if scale > 0.0:
        to_file, from_file = (lambda a: a / scale), (lambda a: a * scale)
    elif scale < 0.0:
        to_file = lambda a: (a - 180.0) / -scale + 180.0  # noqa: E731
        from_file = lambda a: (a - 180.0) * -scale + 180.0  # noqa: E731
    ends = from_file(v[[0, -1]])
    steps = [from_file(v), ends + [-_EDGE, _EDGE], np.array([0.0, 180.0])]
    if shape.is_flat:
        steps.append(np.linspace(0.0, 90.0, 181))
    if shape.cone:
        inner, outer = shape.cone
        steps += [np.linspace(inner, outer, 33), np.array([outer + _EDGE])]
    grid = np.unique(np.concatenate(steps).round(6))
    grid = grid[(grid >= 0.0) & (grid <= 180.0)]
    at = to_file(grid)
    # Roundings do not push the ends out.
    at = np.where((at < v[0]) & (at > v[0] - 1e-4), v[0], at)
    at = np.where((at > v[-1]) & (at < v[-1] + 1e-4), v[-1], at)
    values = np.stack([np.interp(at, v, row, left=0.0, right=0.0) for row in rows])
    if shape.is_flat:
        values *= np.where(grid < 90.0, np.cos(np.radians(grid)), 0.0)
    if shape.cone:
        values *= _within(grid, *shape.cone)
    if shape.normalize and flux > 0.0:
        is_sphere = math.radians(v[-1] - v[0]) > math.pi / 2.0 + 0.1  # as OpenUSD's hdEmbree
        values *= (4.0 if is_sphere else 2.0) * math.pi / flux
    lines = [
        "IESNA:LM-63-2002",
        "TILT=NONE",
        f"1 -1 1 {len(grid)} {len(h)} 1 2 0 0 0",
        "1 1 0",
        *(" ".join(f"{x:.9g}" for x in row) for row in [grid, h, *values]),
    ]
    return "\n".join(lines).encode() + b"\n", list(left_out)


def _within(angle: Array, inner: float, outer: float) -> Array:
    """UsdLux's cone: 1 inside, 0 outside, smooth between."""
    if not outer > inner:
        return np.asarray(angle <= outer, float)
    t = np.clip((angle - inner) / (outer - inner), 0.0, 1.0)
    result: Array = 1.0 - t * t * (3.0 - 2.0 * t)
    return result
