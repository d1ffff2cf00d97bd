"""A relight as a function of torch, whose derivative torch finds by the adjoint: import relumine.torch."""

from __future__ import annotations

import importlib
from typing import Any, Optional, Tuple

import numpy as np

from ._environment import Environment
from ._relighter import Relighter

torch: Any = importlib.import_module("torch")


def _light(relighter: Relighter, environment: Environment, bounces: Optional[int]) -> None:
    relighter.set_environment(environment)
    if bounces != 0:
        relighter.bounce(bounces)


class _Relight(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(
        context: Any,
        pixels: Any,
        relighter: Relighter,
        face_resolution: int,
        bounces: Optional[int],
    ) -> Any:
        array = pixels.detach().cpu().numpy()
        environment = Environment(array, face_resolution=face_resolution)
        _light(relighter, environment, bounces)
        context.light = relighter, environment, bounces
        context.size = None if array.ndim == 4 else array.shape[1::-1]
        return torch.from_numpy(relighter.radiance.copy()).to(pixels.device, pixels.dtype)

    @staticmethod
    def backward(context: Any, weights: Any) -> Tuple[Any, ...]:
        # Other light may have come since: sharp lights and bounces are those of this one.
        _light(*context.light)
        gradient = context.light[0].adjoint(weights.detach().cpu().numpy(), size=context.size)
        return torch.from_numpy(np.array(gradient)).to(weights.device, weights.dtype), None, None, None


def relight(
    relighter: Relighter,
    pixels: Any,
    *,
    face_resolution: Optional[int] = None,
    bounces: Optional[int] = 0,
) -> Any:
    """The radiance (num_receivers, 3) under an environment, which torch can differentiate.

    pixels           (H, 2 H, 3) a lat-long, or (6, R, R, 3) cube faces: linear radiance, not negative
    face_resolution  R of the cube map that a lat-long becomes, H // 2 by default: always the same
    bounces          as Relighter.bounce() takes them; 0: direct light

    The relighter is in this light afterwards. Relighter(scene, clusters_only=True) suits it best.
    """
    if pixels.ndim == 4:
        face_resolution = pixels.shape[1]
    elif face_resolution is None:
        face_resolution = max(pixels.shape[0] // 2, 1)
    result: Any = _Relight.apply(pixels, relighter, face_resolution, bounces)
    return result
