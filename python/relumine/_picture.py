"""Pictures."""

from __future__ import annotations

import importlib
import inspect
import os
from typing import Any, Callable, Optional, Tuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, floats, real, word
from ._files import Path, errors, in_python


_Function = TypeVar("_Function", bound=Callable[..., Any])


def with_picture_options(function: _Function) -> _Function:
    """Gives a function of **options the signature and the help of the options of pictures."""
    blur = ("blur", None, "degrees: background 'blur=DEGREES'", 5.0)
    rows = [*_core.picture_options(), blur]
    own = inspect.signature(function)
    parameters = [each for each in own.parameters.values() if each.kind is not each.VAR_KEYWORD]
    for name, default, _, _ in rows:
        parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default))
    setattr(function, "__signature__", own.replace(parameters=parameters))
    told = "\n".join(f"{name:12} {in_python(help)}" for name, _, help, _ in rows)
    function.__doc__ = f"{inspect.getdoc(function)}\n\nAll options:\n\n{told}\n"
    return function


class Picture(np.ndarray[Any, np.dtype[np.float32]]):
    """Linear RGB radiance as an array: (H, W, 3), or (H, W, 4) with alpha multiplied in.

    Notebooks show it. `exposure` in stops is what suits it; png() and save() apply it.

    >>> picture = relighter.picture(size=(64, 48))
    >>> picture.shape, picture.dtype
    ((48, 64, 3), dtype('float32'))
    """

    #: Stops that suit what is seen.
    exposure: float
    tone_map: str

    def __new__(
        cls, pixels: ArrayLike, *, exposure: float = 0.0, tone_map: str = "neutral"
    ) -> "Picture":
        channels = 4 if np.shape(pixels)[-1:] == (4,) else 3
        picture = floats("pixels", pixels, None, None, channels).view(cls)
        picture.exposure = exposure
        picture.tone_map = tone_map
        return picture

    def __array_finalize__(self, source: Any) -> None:
        self.exposure = getattr(source, "exposure", 0.0)
        self.tone_map = getattr(source, "tone_map", "neutral")

    def _parts(self) -> Tuple[Floats, int, int, Optional[Floats]]:
        channels = 4 if self.ndim == 3 and self.shape[2] == 4 else 3
        array = floats("picture", np.asarray(self), None, None, channels)
        height, width, _ = array.shape
        alpha = np.ascontiguousarray(array[..., 3]) if channels == 4 else None
        return np.ascontiguousarray(array[..., :3]), width, height, alpha

    def denoised(
        self, *, albedo: Optional[ArrayLike] = None, normals: Optional[ArrayLike] = None
    ) -> "Picture":
        """The picture without grain, by Intel's Open Image Denoise: pip install relumine[denoise].

        albedo   (H, W, 3) from 0 to 1: keeps edges of textures
        normals  (H, W, 3): keeps edges of shapes

        For the eye, not for numbers: what is finer than the grain is smoothed away with it, and the
        error that is left is no noise. Alpha stays as it is.
        """
        try:
            pyoidn: Any = importlib.import_module("pyoidn")
        except ImportError:
            raise ImportError(
                "denoised() needs Open Image Denoise: pip install relumine[denoise]"
            ) from None
        colors, width, height, alpha = self._parts()
        guides = {
            name: None if guide is None else floats(name, guide, height, width, 3)
            for name, guide in (("albedo", albedo), ("normals", normals))
        }
        smooth = pyoidn.denoise(colors, guides["albedo"], guides["normals"], hdr=True)
        if alpha is not None:
            smooth = np.concatenate([smooth, alpha[..., None]], axis=2)
        return Picture(smooth, exposure=self.exposure, tone_map=self.tone_map)

    def png(self, *, exposure: Optional[float] = None, tone_map: Optional[str] = None) -> bytes:
        """A PNG file: exposed, through the tone curve (neutral, agx, aces or none), sRGB.

        >>> picture.png()[1:4]
        b'PNG'
        """
        with errors():
            return _core.picture_png(
                *self._parts(),
                real("exposure", self.exposure if exposure is None else exposure),
                word("tone_map", self.tone_map if tone_map is None else tone_map),
            )

    def save(
        self, path: Path, *, exposure: Optional[float] = None, tone_map: Optional[str] = None
    ) -> None:
        """Writes .png as png(), or .exr: linear, without exposure unless it is given."""
        with errors(path):
            name = os.fspath(path)
            if exposure is None:
                exposure = 0.0 if name.lower().endswith(".exr") else self.exposure
            _core.save_picture(
                name,
                *self._parts(),
                real("exposure", exposure),
                word("tone_map", self.tone_map if tone_map is None else tone_map),
            )

    def _repr_png_(self) -> Optional[bytes]:
        is_picture = self.ndim == 3 and self.shape[2] in (3, 4) and self.size > 0
        return self.png() if is_picture else None
