"""Arrays as users have them, converted once into what the compiled part takes."""

from __future__ import annotations

import operator
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Indices = NDArray[np.uint32]


def expect(name: str, value: Any, wanted: type, hint: str = "") -> None:
    """Refuses what is no object of a class of Relumine's."""
    if not isinstance(value, wanted):
        got = type(value).__name__
        raise TypeError(f"{name}: expected a relumine.{wanted.__name__}, got {got}{hint}")


def whole(name: str, value: Any, least: int = 0, most: int = 2**32 - 1) -> int:
    """A whole number from `least` to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        got = type(value).__name__
        raise TypeError(f"{name}: expected a whole number, got {got}") from None
    if not least <= number <= most:
        raise ValueError(f"{name}: expected a whole number from {least} to {most}, got {number}")
    return number


def real(name: str, value: Any) -> float:
    """A number."""
    if isinstance(value, str) or not hasattr(value, "__float__"):
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}")
    return float(value)


def word(name: str, value: Any) -> str:
    """A word, as the name of a method."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a name, got {type(value).__name__}")
    return value


def view(array: Any) -> Any:
    """A numpy array of what the compiled part holds: no copy, read-only, keeps its owner alive."""
    return np.asarray(memoryview(array))


def numbers(name: str, value: ArrayLike, *shape: Optional[int]) -> NDArray[Any]:
    """A copy of `value`, which holds numbers in a shape, where None is any size above 0.

    A copy: what is checked must not change before it is taken, whatever other threads write.
    """
    if value is None:
        raise TypeError(f"{name}: expected an array, got None")
    try:
        array = np.array(value)
    except ValueError:
        raise ValueError(f"{name}: expected an array, got rows of different lengths") from None
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name}: expected numbers, got elements of type {array.dtype}")
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape)
    )
    if not fits:
        letters = iter("NMKL")
        words = ", ".join(next(letters) if size is None else str(size) for size in shape)
        raise ValueError(
            f"{name}: expected shape ({words}{',' if len(shape) == 1 else ''}), got {array.shape}"
        )
    if array.size == 0:
        raise ValueError(f"{name}: expected at least one row, got none")
    return array


def _first(wrong: NDArray[np.bool_]) -> Tuple[int, ...]:
    return tuple(int(i) for i in np.argwhere(wrong)[0])


def floats(name: str, value: ArrayLike, *shape: Optional[int], finite: bool = True) -> Floats:
    """float32 in C order."""
    array = numbers(name, value, *shape)
    with np.errstate(over="ignore", invalid="ignore"):
        result = np.ascontiguousarray(array, dtype=np.float32)
    if finite and not np.isfinite(result).all():
        place = _first(~np.isfinite(result))
        raise ValueError(
            f"{name}: expected finite numbers, got {array[place]} at {list(place)}"
        )
    return result


def doubles(name: str, value: ArrayLike, *shape: Optional[int]) -> Doubles:
    """float64 in C order."""
    result = np.ascontiguousarray(numbers(name, value, *shape), dtype=np.float64)
    if not np.isfinite(result).all():
        place = _first(~np.isfinite(result))
        raise ValueError(f"{name}: expected finite numbers, got {result[place]} at {list(place)}")
    return result


def indices(name: str, value: ArrayLike, limit: int, *shape: Optional[int]) -> Indices:
    """uint32 in C order, each below `limit`. Floats are taken where they are whole numbers."""
    array = numbers(name, value, *shape)
    with np.errstate(invalid="ignore"):
        wrong = ~((array >= 0) & (array < limit))
        if array.dtype.kind == "f":
            wrong |= array != np.floor(array)
    if wrong.any():
        place = _first(wrong)
        raise ValueError(
            f"{name}: expected whole numbers from 0 to {limit - 1}, got {array[place]} at "
            f"{list(place)}"
        )
    return np.ascontiguousarray(array, dtype=np.uint32)
