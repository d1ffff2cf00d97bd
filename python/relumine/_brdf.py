"""Measured BRDFs, and functions."""

from __future__ import annotations

import os
from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import floats, view
from ._core import Brdf as CoreBrdf
from ._files import Path, errors


class Brdf:
    """Any isotropic BRDF, as a table. A material of precompute(), for scenes with a view.

    Made by Brdf.load(), Brdf.table() and Brdf.of().
    """

    _core: CoreBrdf

    @classmethod
    def _of(cls, core: CoreBrdf) -> "Brdf":
        brdf = cls.__new__(cls)
        brdf._core = core
        return brdf

    @classmethod
    def load(cls, path: Path) -> "Brdf":
        """Reads a .binary file of the MERL database. Raises OSError with the file's name."""
        with errors(path):
            return cls._of(_core.load_brdf(os.fspath(path)))

    @classmethod
    def table(cls, values: ArrayLike) -> "Brdf":
        """Takes a table.

        values  (3, 90, 90, 90) in 1/sr: red, green and blue by theta_h (it grows with the square
                of its index), theta_d and phi_d (a quarter of a turn), at the middles of places.
                Where light or eye is below the horizon they may be anything

        Raises ValueError where it is negative or not finite, or reflects more than arrives.
        """
        given = floats("values", values, 3, 90, 90, 90, finite=False)
        return cls._of(_core.brdf_table(np.ascontiguousarray(given.reshape(3, -1).T)))

    @classmethod
    def of(
        cls,
        function: Callable[[NDArray[np.float32], NDArray[np.float32]], "NDArray[np.floating[Any]]"],
    ) -> "Brdf":
        """Tabulates a function. It is called once, with all directions.

        function  takes unit vectors to the light and to the eye (N, 3), the normal being +Z, and
                  gives values (N, 3) or, for grey, (N,), in 1/sr

        Raises ValueError where it is negative or not finite, reflects more than arrives, or is not
        reciprocal and isotropic.

        >>> matt = relumine.Brdf.of(lambda light, eye: np.full(len(light), 0.5 / np.pi))
        """
        directions = view(_core.brdf_questions())
        values = np.asarray(function(directions[:, 0], directions[:, 1]))
        if values.ndim == 1:
            values = np.repeat(values[:, np.newaxis], 3, axis=1)
        return cls._of(_core.brdf_of(_answers(values, len(directions))))


def _answers(values: "NDArray[np.floating[Any]]", count: int) -> NDArray[np.float32]:
    """What the function gave, with a shape that fits."""
    if values.shape != (count, 3) or values.dtype.kind not in "iuf":
        raise ValueError(
            f"function: expected numbers of shape ({count}, 3) or ({count},), got {values.dtype} "
            f"of shape {values.shape}"
        )
    return np.ascontiguousarray(values, dtype=np.float32)
