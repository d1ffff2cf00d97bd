"""Textures: passed on as they are, or made anew where glTF packs channels in another way."""

from __future__ import annotations

import importlib
import io
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray
from pxr import Ar  # type: ignore

from ._glb import Glb
from ._notes import Notes

Array = NDArray[Any]
#: Texels along a side: the reader's limit.
LARGEST = 16384
_KINDS = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
_WRAP = {"repeat": 10497, "periodic": 10497, "mirror": 33648, "clamp": 33071, "black": 33071}


@dataclass(frozen=True)
class Place:
    """Where a texture is looked up: st of a primvar, scaled, rotated, moved."""

    primvar: str = "st"
    scale: Tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0
    translation: Tuple[float, float] = (0.0, 0.0)
    wrap: Tuple[str, str] = ("repeat", "repeat")

    def transform(self) -> Optional[Dict[str, Any]]:
        """KHR_texture_transform of it, whose v counts from the top; None where nothing moves."""
        if (self.scale, self.rotation, self.translation) == ((1.0, 1.0), 0.0, (0.0, 0.0)):
            return None
        angle = np.radians(self.rotation)
        c, s = np.cos(angle), np.sin(angle)
        matrix = np.array([[c * self.scale[0], s * self.scale[1]],
                           [-s * self.scale[0], c * self.scale[1]]])  # fmt: skip
        top = np.array([0.0, 1.0])
        offset = np.array([1.0, -1.0]) * self.translation + top - matrix @ top
        return {
            "offset": offset.tolist(),
            "scale": [float(x) for x in self.scale],
            "rotation": float(angle),
        }


@dataclass(frozen=True)
class Image:
    """A texture of a material's input, or one channel of it.

    channels  of red, green, blue, alpha: "rgb", or one letter
    """

    path: str
    channels: str
    place: Place
    space: str = "auto"
    scale: Tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    bias: Tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    fallback: Tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)

    @property
    def is_plain(self) -> bool:
        used = ["rgba".index(c) for c in self.channels]
        return all(self.scale[i] == 1.0 and self.bias[i] == 0.0 for i in used)


#: What an input of a material is: a number, a colour, or a texture.
Input = Union[float, Tuple[float, ...], Image]


def to_linear(x: Array) -> Array:
    return np.where(x <= 0.04045, x / 12.92, ((np.maximum(x, 0.04045) + 0.055) / 1.055) ** 2.4)


def to_srgb(x: Array) -> Array:
    return np.where(
        x <= 0.0031308, x * 12.92, 1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055
    )


def read_asset(path: str) -> bytes:
    """The content of a resolved path, inside of packages too. Raises OSError."""
    if Ar.IsPackageRelativePath(path):
        import zipfile

        package, inner = Ar.SplitPackageRelativePathOuter(path)
        content: Any = package
        while True:
            here, inner_rest = inner, ""
            if Ar.IsPackageRelativePath(inner):
                here, inner_rest = Ar.SplitPackageRelativePathOuter(inner)
            try:
                with zipfile.ZipFile(content) as file:
                    data = file.read(here)
            except (KeyError, zipfile.BadZipFile) as error:
                raise OSError(str(error)) from None
            if not inner_rest:
                return data
            content, inner = io.BytesIO(data), inner_rest
    with open(path, "rb") as file:
        return file.read()


class Images:
    """The textures of a scene, each once."""

    def __init__(self, glb: Glb, notes: Notes) -> None:
        self._glb, self._notes = glb, notes
        self._bytes: Dict[str, Optional[bytes]] = {}
        self._pixels: Dict[str, Optional[Array]] = {}
        self._made: Dict[Any, Optional[Tuple[int, float]]] = {}

    def content(self, path: str) -> Optional[bytes]:
        if path not in self._bytes:
            try:
                self._bytes[path] = read_asset(path)
            except OSError as error:
                reason = error.strerror or str(error)
                self._notes.add(f"a texture is left out: {reason}", path)
                self._bytes[path] = None
        return self._bytes[path]

    def _kind(self, path: str) -> str:
        data = self.content(path) or b""
        if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
            return "image/webp"
        return next((kind for mark, kind in _KINDS.items() if data.startswith(mark)), "")

    def pixels(self, path: str) -> Optional[Array]:
        """(H, W, 1 to 4) in 0 to 1, as the file has them; None, with a note, without any."""
        if path not in self._pixels:
            self._pixels[path] = self._decoded(path)
        return self._pixels[path]

    def _decoded(self, path: str) -> Optional[Array]:
        data = self.content(path)
        if data is None:
            return None
        if data[:4] == b"\x76\x2f\x31\x01" or data[:2] == b"#?":
            return self._of_environment(path, data)
        try:
            Pillow = importlib.import_module("PIL.Image")
        except ImportError:
            self._notes.add(
                "a texture is left out: its channels are read by pillow "
                "(pip install relumine[usd])", path,
            )  # fmt: skip
            return None
        try:
            with Pillow.open(io.BytesIO(data)) as picture:
                if max(picture.size) > LARGEST:
                    raise OSError(
                        f"expected at most {LARGEST} x {LARGEST} texels, got "
                        f"{picture.size[0]} x {picture.size[1]}"
                    )
                if picture.mode in ("P", "PA", "CMYK", "YCbCr", "LAB", "HSV", "1"):
                    has_alpha = "transparency" in picture.info or picture.mode == "PA"
                    picture = picture.convert("RGBA" if has_alpha else "RGB")
                array = np.asarray(picture)
        except Exception as error:  # whatever a decoder says of a file
            words = str(error).replace("\n", " ")
            if "cannot identify" in words:
                words = "expected a picture, got something else"
            self._notes.add(f"a texture is left out: {words[:160]}", path)
            return None
        scale = {"u": float(np.iinfo(array.dtype).max) if array.dtype.kind == "u" else 1.0}
        divisor = scale["u"]
        if array.dtype == np.int32:  # Pillow's 16 bits
            divisor = 65535.0
        result = array.astype(np.float32) / divisor
        return result[..., None] if result.ndim == 2 else result

    def _of_environment(self, path: str, data: bytes) -> Optional[Array]:
        """An .exr or .hdr, by the reader of environments, which takes any size as a lat-long."""
        import os
        import tempfile

        from .._environment import Environment

        suffix = ".exr" if data[:1] == b"\x76" else ".hdr"
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "texture" + suffix)
            with open(name, "wb") as file:
                file.write(data)
            try:
                return np.array(Environment.load(name, layout="latlong", fix_env=True).pixels)
            except (OSError, ValueError) as error:
                words = str(error).replace(name, "").lstrip(": ")
                self._notes.add(f"a texture is left out: {words}", path)
                return None

    def _is_srgb(self, image: Image, pixels: Optional[Array] = None) -> bool:
        if image.space in ("sRGB", "srgb_texture", "srgb_rec709_scene", "srgb_rec709_display"):
            return True
        if image.space == "auto":
            # UsdPreviewSurface: of 8 bits, with 3 or 4 channels.
            kind = self._kind(image.path)
            if kind in ("image/jpeg", "image/webp"):
                return pixels is None or pixels.shape[2] >= 3
            data = self.content(image.path) or b""
            if kind == "image/png" and len(data) > 26:
                return data[24] == 8 and data[25] in (2, 3, 6)
            return kind == "" and not (data[:4] == b"\x76\x2f\x31\x01" or data[:2] == b"#?")
        return False

    def values(self, image: Image) -> Optional[Array]:
        """(H, W, n) linear values of an image's channels, with its scale and bias."""
        pixels = self.pixels(image.path)
        if pixels is None:
            return None
        count = pixels.shape[2]
        columns = []
        is_srgb = self._is_srgb(image, pixels)
        for c in image.channels:
            i = "rgba".index(c)
            if c == "a":
                values = (
                    pixels[..., -1] if count in (2, 4) else np.ones(pixels.shape[:2], np.float32)
                )
            else:
                values = pixels[..., 0 if count < 3 else i]
                if is_srgb:
                    values = to_linear(values)
            columns.append(values * np.float32(image.scale[i]) + np.float32(image.bias[i]))
        result: Array = np.stack(columns, -1).astype(np.float32)
        return result

    def linear(self, path: str) -> Optional[Array]:
        """(H, W, 3) linear values of a picture."""
        return self.values(Image(path, "rgb", Place()))

    def exists(self, image: Image) -> bool:
        return self.content(image.path) is not None

    def texture(
        self, channels: Sequence[Input], *, is_srgb: bool, alpha: Optional[Input] = None
    ) -> Tuple[Optional[int], float]:
        """The glTF texture of one input (a colour), or of one for each channel, and a factor on it.

        The factor is more than 1 where values are. (None, 1) where nothing can be read.
        """
        images = [c for c in [*channels, alpha] if isinstance(c, Image)]
        place = images[0].place
        for other in images[1:]:
            if other.place != place:
                self._notes.add(
                    "textures of one glTF texture are at several places: the first counts",
                    other.path,
                )
        key = (tuple(channels), alpha, is_srgb)
        if key not in self._made:
            self._made[key] = self._make(channels, is_srgb, alpha)
        made = self._made[key]
        if made is None:
            return None, 1.0
        image_index, factor = made
        wrap = [_WRAP.get(w, 10497) for w in place.wrap]
        if "black" in place.wrap:
            self._notes.add("wrap black: the rim's colour goes on", images[0].path)
        return self._glb.texture(image_index, wrap[0], wrap[1]), factor

    def _make(self, channels: Sequence[Input], is_srgb: bool, alpha: Optional[Input]) -> Any:
        first = channels[0]
        assert isinstance(first, Image) or any(isinstance(c, Image) for c in [*channels, alpha])
        if (
            len(channels) == 1
            and isinstance(first, Image)
            and first.channels == "rgb"
            and first.is_plain
        ):
            own_alpha = alpha is None or (
                isinstance(alpha, Image)
                and (alpha.path, alpha.channels) == (first.path, "a")
                and alpha.is_plain
            )
            kind = self._kind(first.path)
            if kind and own_alpha and self._is_srgb(first) == is_srgb:
                data = self.content(first.path)
                if kind == "image/webp":
                    self._glb.use("EXT_texture_webp")
                return (self._glb.image(data, kind, first.path), 1.0) if data else None
        arrays: List[Array] = []
        for c in [*channels, *([] if alpha is None else [alpha])]:
            if isinstance(c, Image):
                values = self.values(c)
                if values is None:
                    fallback = [c.fallback["rgba".index(x)] for x in c.channels]
                    values = np.array(fallback, np.float32).reshape(1, 1, -1)
            else:
                values = np.array(c, np.float32).reshape(1, 1, -1)
            arrays.append(values)
        if all(a.shape[:2] == (1, 1) for a in arrays):
            return None
        height = max(a.shape[0] for a in arrays)
        width = max(a.shape[1] for a in arrays)
        arrays = [_resized(a, height, width) for a in arrays]
        color = np.concatenate(arrays if alpha is None else arrays[:-1], -1)
        factor = max(float(color.max()), 1.0) if is_srgb else 1.0
        color = np.clip(color / factor, 0.0, 1.0)
        if is_srgb:
            color = to_srgb(color)
        pixels = color if alpha is None else np.concatenate([color, np.clip(arrays[-1], 0, 1)], -1)
        name = next(c.path for c in [*channels, alpha] if isinstance(c, Image))
        return self._glb.image(png(pixels), "image/png", name), factor


def _resized(values: Array, height: int, width: int) -> Array:
    if values.shape[:2] == (height, width):
        return values
    y = (np.arange(height) * values.shape[0]) // height
    x = (np.arange(width) * values.shape[1]) // width
    result: Array = values[y][:, x]
    return result


def png(pixels: Array) -> bytes:
    """A PNG of (H, W, 1, 3 or 4) numbers of 0 to 1."""
    import struct
    import zlib

    if pixels.shape[2] == 2:
        raise ValueError("expected 1, 3 or 4 channels")
    data = np.rint(pixels * 255.0).astype(np.uint8)
    height, width, count = data.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), data.reshape(height, -1)], 1)

    def chunk(kind: bytes, content: bytes) -> bytes:
        return (
            struct.pack(">I", len(content)) + kind + content
            + struct.pack(">I", zlib.crc32(kind + content))
        )  # fmt: skip

    color = {1: 0, 3: 2, 4: 6}[count]
    header = struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")
    )  # fmt: skip
