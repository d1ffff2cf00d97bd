"""Lists of distant lights."""

from __future__ import annotations

import os
from typing import Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Doubles, doubles, real, view, word
from ._files import Path, errors


class LightList:
    """A few distant lights that stand for an environment.

    directions    (N, 3) from the scene to the light; brought to unit length
    irradiances   (N, 3) RGB on a surface that faces the light
    solid_angles  (N,) of the part of the sphere that each stands for, sr; 0: a point
    """

    directions: Doubles
    irradiances: Doubles
    solid_angles: Doubles
    method: str

    def __init__(
        self,
        directions: ArrayLike,
        irradiances: ArrayLike,
        solid_angles: Optional[ArrayLike] = None,
        *,
        method: str = "",
    ) -> None:
        self.directions = doubles("directions", directions, None, 3)
        count = len(self.directions)
        lengths = np.linalg.norm(self.directions, axis=1, keepdims=True)
        if not (lengths > 0.0).all():
            raise ValueError("directions: expected vectors of any length but zero")
        self.directions = np.where(np.abs(lengths - 1.0) < 1e-12, self.directions,
                                   self.directions / lengths)  # fmt: skip
        self.irradiances = doubles("irradiances", irradiances, count, 3)
        if (self.irradiances < 0.0).any():
            raise ValueError("irradiances: expected numbers that are not negative")
        angles = np.zeros(count) if solid_angles is None else solid_angles
        self.solid_angles = doubles("solid_angles", angles, count)
        self.method = method

    @classmethod
    def load(cls, path: Path) -> "LightList":
        """Reads a .json light list. Raises OSError with the file's name."""
        with errors(path):
            (w, e, a), _, method = _core.load_lights(os.fspath(path))
        return cls(view(w), view(e), view(a), method=method)

    def save(
        self,
        path: Path,
        *,
        format: Optional[str] = None,
        soft: bool = False,
        lumens_per_watt: float = 1.0,
    ) -> None:
        """Writes the list; the extension chooses the format.

        format  json, csv, pbrt, mitsuba (.xml), usd (.usda), blender (.py) or gltf
        soft    lights as wide as the part of the sphere that they stand for (USD, Blender)

        >>> environment.median_cut(8).save("lights.json")
        >>> len(relumine.LightList.load("lights.json"))
        8
        """
        with errors(path):
            _core.save_lights(
                os.fspath(path),
                *self._arrays(),
                self.method,
                None if format is None else word("format", format),
                bool(soft),
                real("lumens_per_watt", lumens_per_watt),
            )

    def _arrays(self) -> Tuple[Doubles, Doubles, Doubles]:
        # Whoever has the list may have changed its arrays.
        checked = LightList(self.directions, self.irradiances, self.solid_angles)
        return checked.directions, checked.irradiances, checked.solid_angles

    @property
    def total_irradiance(self) -> Doubles:
        """(3,) the sum of the lights."""
        result: Doubles = self.irradiances.sum(axis=0)
        return result

    def __len__(self) -> int:
        return len(self.directions)

    def __repr__(self) -> str:
        method = f" by {self.method}" if self.method else ""
        return f"<relumine.LightList: {len(self)} lights{method}>"
