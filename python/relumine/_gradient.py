"""A relight and its transpose in numpy, for the packages that differentiate: torch.py and jax.py."""

from __future__ import annotations

import threading
from typing import Any, NamedTuple, Optional, Sequence

import numpy as np

from ._arrays import Floats
from ._environment import Environment
from ._relighter import Relighter

# A relighter's light and what is read of it belong together, whichever thread asks.
_lock = threading.Lock()


class Relight(NamedTuple):
    """How pixels light a scene."""

    relighter: Relighter
    face_resolution: int
    bounces: Optional[int]

    def _light(self, pixels: Any) -> None:
        self.relighter.set_environment(Environment(pixels, face_resolution=self.face_resolution))
        if self.bounces != 0:
            self.relighter.bounce(self.bounces)

    def radiance(self, pixels: Any) -> Floats:
        """(num_receivers, 3)."""
        with _lock:
            self._light(pixels)
            return self.relighter.radiance.copy()

    def gradient(self, pixels: Any, weights: Any) -> Floats:
        """In the shape of the pixels: the derivative of a loss whose derivative by radiance is `weights`."""
        size = None if pixels.ndim == 4 else pixels.shape[1::-1]
        with _lock:
            # Other light may have come since: sharp lights and bounces are those of this one.
            self._light(pixels)
            return np.array(self.relighter.adjoint(weights, size=size))


def relight_of(
    relighter: Relighter, shape: Sequence[int], face_resolution: Optional[int], bounces: Optional[int]
) -> Relight:
    """`shape` is that of the pixels."""
    is_cube = len(shape) == 4 and shape[0] == 6 and shape[1] == shape[2]
    is_lat_long = len(shape) == 3 and shape[1] == 2 * shape[0]
    if not (is_cube or is_lat_long) or shape[-1] != 3:
        raise ValueError(f"pixels: expected shape (H, 2 H, 3) or (6, R, R, 3), got {tuple(shape)}")
    if is_cube:
        face_resolution = shape[1]
    elif face_resolution is None:
        face_resolution = max(shape[0] // 2, 1)
    return Relight(relighter, face_resolution, bounces)
