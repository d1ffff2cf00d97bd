"""Relumine relights 3D meshes under measured light.

    scene = relumine.precompute(relumine.Mesh.load("bunny.ply", floor="auto"))
    relighter = relumine.Relighter(scene)
    relighter.set_environment(relumine.Environment.load("studio.exr"))
    relighter.picture().save("bunny.png")

precompute() finds once per mesh how much light reaches every vertex from every direction, with all
shadows. A Relighter then lights it with any environment in milliseconds, and edits cost only what
they touch. Options have the names of the command line. Arrays may have any type and order; what
comes back is float32 in C order. The world is right-handed with +Y up; a direction points from the
scene to the light; colours are linear RGB.

Bad arguments raise ValueError that names them, files OSError with the file's name, too little
memory MemoryError. Ctrl-C raises KeyboardInterrupt within a tenth of a second.
"""

import atexit as _atexit
from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

from . import _arrays, _core
from ._brdf import Brdf
from ._environment import Environment
from ._files import FileError
from ._harmonics import irradiance
from ._layers import SHAPES as _SHAPES
from ._layers import Emit, Gain, Image, Layer, load_layers, save_layers
from ._lights import LightList
from ._mesh import Mesh, RelumineWarning
from ._moves import Move
from ._picture import Picture
from ._relighter import (
    FACES,
    Bounces,
    FittedEnvironment,
    FittedLights,
    Frame,
    Relighter,
    RelightTimes,
    Share,
    Update,
    Verification,
)
from ._scene import Blinn, Ggx, Lambert, Scene, join, plan, precompute, precompute_part

__version__: str = _core.__version__
__all__ = [
    "FACES", "Blinn", "Bounces", "Brdf", "Emit", "Environment", "FileError", "FittedEnvironment", "FittedLights", "Frame", "Gain", "Ggx",
    "Image", "Lambert", "Layer", "LightList", "Mesh", "Move", "Picture",
    "RelightTimes", "Relighter", "RelumineWarning", "Scene", "Share", "Update",
    "Verification", "irradiance", "join", "load_layers", "plan", "precompute", "precompute_part", "save_layers",
    "set_threads", *_SHAPES,
]  # fmt: skip
# Regions of layers: Disc, Rectangle, ...
globals().update(_SHAPES)
if _TYPE_CHECKING:

    def __getattr__(name: str) -> _Any: ...


def set_threads(count: int) -> None:
    """Limits the threads that all calls use together; 0: all."""
    _core.set_threads(_arrays.whole("count", count, most=2**31 - 1))


# The modules below are an inner matter.
for _name in __all__:
    if callable(globals()[_name]):
        globals()[_name].__module__ = __name__
del _name

# Work that Ctrl-C left behind ends before the process does.
_atexit.register(_core.wait_for_jobs)

