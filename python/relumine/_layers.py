"""Light layers: what an artist puts over an environment."""

from __future__ import annotations

import json
import os
import re
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, make_dataclass
from dataclasses import field as dataclass_field
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    Optional,
    Sequence,
    Union,
)

import numpy as np

from . import _core
from ._files import Path, errors

Direction = Sequence[float]
Rgb = Sequence[float]



def _shapes() -> Dict[str, Any]:
    """The classes of regions, by the names in layer files: Disc, Rectangle, ..."""
    types: Dict[str, Any] = {"number": float, "direction": Direction, "points": Sequence[Direction]}
    result = {}
    for name, about, shape_fields in _core.layer_shapes():
        members: List[Any] = [
            (field, types[kind])
            if default is None
            else (field, types[kind], dataclass_field(default=default))
            for field, kind, default in shape_fields
        ]
        result[name] = make_dataclass(
            name.capitalize(), members, namespace={"type": name, "__doc__": about}
        )
    return result


_REGIONS = _shapes()
SHAPES: Dict[str, Any] = {shape.__name__: shape for shape in _REGIONS.values()}
globals().update(SHAPES)
if TYPE_CHECKING:

    def __getattr__(name: str) -> Any: ...


@dataclass
class Emit:
    """Adds radiance."""

    radiance: Rgb
    effect: ClassVar[str] = "emit"


@dataclass
class Gain:
    """Multiplies the light below."""

    factor: float = 1.0
    tint: Rgb = (1.0, 1.0, 1.0)
    effect: ClassVar[str] = "gain"


@dataclass
class Image:
    """Places a picture, .exr or .hdr, on a Rectangle. `blend` is replace or add."""

    path: str
    blend: str = "replace"
    effect: ClassVar[str] = "image"


Region = Any
Effect = Union[Emit, Gain, Image]
_EFFECTS: Dict[str, Any] = {"emit": Emit, "gain": Gain, "image": Image}


@dataclass
class Layer:
    """A region, what happens in it, and how strongly: `gain_ev` in stops.

    `kelvin`, from 1000 to 15000, multiplies by a colour. Where a layer has `solo`, only such layers
    shine. One with `camera` False gives light and is not seen behind the scene.

    Directions point from the scene to the light, +Y up; colours are linear RGB. A layer is the same
    as a dictionary of a layer file, and functions take both.

    >>> key = relumine.Layer("key", relumine.Disc((1, 1, 1), 8), relumine.Emit((40, 38, 35)))
    >>> key.to_dict()["type"]
    'disc'
    """

    name: str
    region: Region
    effect: Effect
    on: bool = True
    gain_ev: float = 0.0
    kelvin: float = 0.0
    solo: bool = False
    camera: bool = True

    def to_dict(self) -> Dict[str, Any]:
        """The layer as a layer file has it."""
        return {
            "name": self.name,
            "on": self.on,
            "solo": self.solo,
            "camera": self.camera,
            "gain_ev": self.gain_ev,
            "kelvin": self.kelvin,
            "type": self.region.type,
            **asdict(self.region),
            "effect": self.effect.effect,
            **asdict(self.effect),
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> "Layer":
        """The layer of a dictionary as layer files have them. Raises ValueError for any other."""
        (layer,) = parsed(_core.checked_layers(text_of([values])))
        return layer


def parsed(text: str) -> List[Layer]:
    """Layers of a text that the compiled part wrote."""
    result = []
    for values in json.loads(text)["layers"]:
        region, effect = _REGIONS[values["type"]], _EFFECTS[values["effect"]]
        result.append(
            Layer(
                values["name"],
                region(**{f.name: values[f.name] for f in fields(region) if f.name in values}),
                effect(**{f.name: values[f.name] for f in fields(effect) if f.name in values}),
                values.get("on", True),
                values.get("gain_ev", 0.0),
                values.get("kelvin", 0.0),
                values.get("solo", False),
                values.get("camera", True),
            )
        )
    return result


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise ValueError(f"layers: expected numbers and text, got {value!r}")


def text_of(layers: Sequence[Union[Layer, Mapping[str, Any]]]) -> str:
    """Layers as JSON, one a line: the line number in a message is the place of the layer."""
    if isinstance(layers, (Layer, Mapping)):
        raise ValueError("layers: expected a list of layers, got one")
    if isinstance(layers, str) or not isinstance(layers, Iterable):
        raise TypeError(f"layers: expected a list of layers, got {type(layers).__name__}")
    lines: List[str] = []
    for layer in layers:
        if not isinstance(layer, (Layer, Mapping)):
            raise TypeError(
                f"layers[{len(lines)}]: expected a relumine.Layer or a dictionary, "
                f"got {type(layer).__name__}"
            )
        values = layer.to_dict() if isinstance(layer, Layer) else layer
        try:
            lines.append(json.dumps(dict(values), default=_plain, allow_nan=False))
        except (TypeError, ValueError) as error:
            raise ValueError(f"layers[{len(lines)}]: {error}") from None
    return "[" + ",\n".join(lines) + "]"


@contextmanager
def naming_layers() -> Iterator[None]:
    """Names the layer in messages by its place: layers:3: becomes layers[2]:."""
    try:
        yield
    except ValueError as error:
        match = re.match(r"layers:(\d+): ", str(error))
        if match is None:
            raise
        text = f"layers[{int(match[1]) - 1}]: {str(error)[match.end():]}"
        raise ValueError(text) from None


def region_text(region: Union[Region, Mapping[str, Any]]) -> str:
    """A region as the layer that has it."""
    values: Dict[str, Any]
    if isinstance(region, Mapping):
        values = dict(region)
    elif not hasattr(region, "type"):
        got = type(region).__name__
        raise TypeError(f"region: expected a region as relumine.Disc, or a dictionary, got {got}")
    else:
        values = {"type": region.type, **asdict(region)}
    return text_of([{"name": "region", "effect": "emit", "radiance": [1, 1, 1], **values}])


def load_layers(path: Path, *, frame: Optional[float] = None) -> List[Layer]:
    """Reads a layer file. With `frame`, the layers at a frame of its key frames.

    Raises OSError with the file's name.
    """
    with errors(path):
        layers = parsed(_core.load_layers(os.fspath(path), frame))
    for layer in layers:
        if isinstance(layer.effect, Image):  # relative to the file
            layer.effect.path = os.path.join(os.path.dirname(os.fspath(path)), layer.effect.path)
    return layers


def save_layers(path: Path, layers: Sequence[Union[Layer, Mapping[str, Any]]]) -> None:
    """Writes a layer file that `relumine edit` and load_layers() read."""
    with errors(path), naming_layers():
        _core.save_layers(os.fspath(path), text_of(layers))
