"""Irradiance from spherical harmonics."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Doubles, doubles


def _basis(normals: Doubles, count: int) -> Doubles:
    """The basis functions times what turns arriving light into irradiance, (N, count)."""
    x, y, z = np.moveaxis(normals, -1, 0)
    one = np.ones_like(x)
    first, second = math.sqrt(3 / (4 * math.pi)), 0.5 * math.sqrt(15 / math.pi)
    values = np.stack(
        [
            0.5 / math.sqrt(math.pi) * one,
            first * y,
            first * z,
            first * x,
            second * x * y,
            second * y * z,
            0.25 * math.sqrt(5 / math.pi) * (3 * z * z - 1),
            second * x * z,
            0.5 * second * (x * x - y * y),
        ],
        axis=-1,
    )
    factors = math.pi * np.array([1, *[2 / 3] * 3, *[1 / 4] * 5])
    result: Doubles = (values * factors)[..., :count]
    return result


def irradiance(harmonics: ArrayLike, normals: ArrayLike) -> Doubles:
    """(N, 3): the irradiance of surfaces in arriving light.

    harmonics  (N, 4 or 9, 3), as Relighter.harmonics has them
    normals    (N, 3) unit vectors, one for each, or one for all (3,)

    It may be a little below zero, because nine coefficients ring.

    >>> sky = np.zeros((1, 9, 3))
    >>> sky[:, 0] = 2 * np.sqrt(np.pi)  # radiance 1 everywhere
    >>> relumine.irradiance(sky, [[0, 1, 0]]).round(6).tolist()
    [[3.141593, 3.141593, 3.141593]]
    """
    light = doubles("harmonics", harmonics, None, None, 3)
    if light.shape[1] not in (4, 9):
        raise ValueError(f"harmonics: expected shape (N, 4 or 9, 3), got {light.shape}")
    if np.shape(normals) == (3,):
        normals = np.broadcast_to(np.asarray(normals), (light.shape[0], 3))
    directions = doubles("normals", normals, light.shape[0], 3)
    lengths = np.linalg.norm(directions, axis=1)
    if np.any((np.abs(lengths - 1) > 1e-3) & (lengths > 0)):
        raise ValueError("normals: expected unit vectors (zero: no surface), got others")
    result: Doubles = np.einsum("nk,nkc->nc", _basis(directions, light.shape[1]), light)
    return result
