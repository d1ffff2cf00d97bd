"""A relight as a function of torch, whose derivative torch finds by the adjoint: import relumine.torch."""

from __future__ import annotations

import importlib
from typing import Any, Optional, Tuple

from ._gradient import Relight, relight_of
from ._relighter import Relighter

torch: Any = importlib.import_module("torch")


class _Relight(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(context: Any, pixels: Any, how: Relight) -> Any:
        context.how, context.pixels = how, pixels.detach().cpu().numpy().copy()
        return torch.from_numpy(how.radiance(context.pixels)).to(pixels.device, pixels.dtype)

    @staticmethod
    def backward(context: Any, weights: Any) -> Tuple[Any, ...]:
        gradient = context.how.gradient(context.pixels, weights.detach().cpu().numpy())
        return torch.from_numpy(gradient).to(weights.device, weights.dtype), None


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
    how = relight_of(relighter, pixels.shape, face_resolution, bounces)
    result: Any = _Relight.apply(pixels, how)
    return result
