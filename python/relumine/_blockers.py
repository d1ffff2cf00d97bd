"""Blockers that are a function."""

from __future__ import annotations

from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, view

#: Answers which of N rays are blocked: origins (N, 3), unit directions (N, 3) -> (N,) booleans.
BlockersFunction = Callable[[Floats, Floats], NDArray[np.bool_]]


def asked(function: Optional[BlockersFunction]) -> Any:
    """The function as the compiled part calls it."""
    if function is None:
        return None
    if not callable(function):
        raise ValueError(f"blockers_function: expected a function, got {function!r}")
    ask = function

    def answer(origins: Any, directions: Any) -> NDArray[np.bool_]:
        starts, ways = view(origins), view(directions)
        result = np.asarray(ask(starts, ways))
        if result.shape != starts.shape[:1] or result.dtype != np.bool_:
            raise ValueError(
                f"blockers_function: expected {len(starts)} booleans, got an array of shape "
                f"{result.shape} and type {result.dtype}"
            )
        return np.ascontiguousarray(result)

    return answer
