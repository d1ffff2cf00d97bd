"""A relight as a function of jax, whose derivative jax finds by the adjoint: import relumine.jax."""

from __future__ import annotations

import importlib
from typing import Any, Optional, Tuple

import numpy as np

from ._gradient import relight_of
from ._relighter import Relighter

jax: Any = importlib.import_module("jax")


def relight(
    relighter: Relighter,
    pixels: Any,
    *,
    face_resolution: Optional[int] = None,
    bounces: Optional[int] = 0,
) -> Any:
    """The radiance (num_receivers, 3) under an environment, for jax.grad(), jax.jit() and jax.vmap().

    pixels           (H, 2 H, 3) a lat-long, or (6, R, R, 3) cube faces: linear radiance, not negative
    face_resolution  R of the cube map that a lat-long becomes, H // 2 by default: always the same
    bounces          as Relighter.bounce() takes them; 0: direct light

    The relighter is in this light afterwards. Relighter(scene, clusters_only=True) suits it best.
    Differentiable once, backwards; the work itself is done on the processor.
    """
    pixels = jax.numpy.asarray(pixels)
    how = relight_of(relighter, pixels.shape, face_resolution, bounces)

    def called(work: Any, shape: Tuple[int, ...], *arguments: Any) -> Any:
        result = jax.ShapeDtypeStruct(shape, pixels.dtype)

        def on_arrays(*arrays: Any) -> Any:
            return work(*(np.asarray(each) for each in arrays)).astype(pixels.dtype)

        return jax.pure_callback(on_arrays, result, *arguments, vmap_method="sequential")

    @jax.custom_vjp  # type: ignore[misc]
    def radiance(pixels: Any) -> Any:
        return called(how.radiance, (relighter.scene.num_receivers, 3), pixels)

    def forward(pixels: Any) -> Tuple[Any, Any]:
        return radiance(pixels), pixels

    def backward(pixels: Any, weights: Any) -> Tuple[Any]:
        return (called(how.gradient, pixels.shape, pixels, weights),)

    radiance.defvjp(forward, backward)
    return radiance(pixels)
