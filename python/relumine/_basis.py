"""Textures of Basis Universal in glTF (KHR_texture_basisu): pip install relumine[basis]."""

from __future__ import annotations

import base64
import json
import os
import struct
import tempfile
import zlib
from contextlib import contextmanager
from typing import Any, Dict, Iterator, List, Optional, Tuple
from urllib.parse import unquote

_EXTENSION = "KHR_texture_basisu"
_MAGIC, _JSON, _BINARY = b"glTF", b"JSON", b"BIN\0"

#: The longest side that the reader of meshes takes.
_LARGEST = 16384


@contextmanager
def readable(path: str) -> Iterator[Tuple[str, List[str]]]:
    """A file that the reader of meshes reads whole, and a line for each texture that is left out.

    It is the file itself where nothing is to be done: another format, no such textures, no
    decoder, a broken file. The reader then says what it finds.
    """
    decoded = _decoded(path)
    if decoded is None:
        yield path, []
        return
    data, notes = decoded
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, os.path.splitext(os.path.basename(path))[0] + ".glb")
        with open(name, "wb") as file:
            file.write(data)
        try:
            yield name, notes
        except RuntimeError as error:
            raise RuntimeError(str(error).replace(name, path)) from None


def _decoded(path: str) -> Optional[Tuple[bytes, List[str]]]:
    """A .glb with PNG in place of a file's Basis textures."""
    if not path.lower().endswith((".glb", ".gltf")):
        return None
    try:
        import opengl_basisu  # type: ignore
    except ImportError:
        return None
    try:
        with open(path, "rb") as file:
            head = file.read(20)
            size = struct.unpack_from("<I", head, 12)[0] if head[:4] == _MAGIC else None
            document = json.loads(head + file.read() if size is None else file.read(size))
            if _EXTENSION not in document.get("extensionsUsed", []):
                return None
            size, kind = struct.unpack("<I4s", file.read(8) or bytes(8))
            chunk = file.read(size) if kind == _BINARY else b""
            if len(chunk) < size:
                return None
        return _Whole(path, document, chunk).glb(opengl_basisu)
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError, struct.error):
        return None


class _Whole:
    """A document with all its files in one binary chunk."""

    def __init__(self, path: str, document: Dict[str, Any], chunk: bytes) -> None:
        self._folder = os.path.dirname(path)
        self._document = document
        self._views: List[Dict[str, Any]] = document.setdefault("bufferViews", [])
        self._parts: List[bytes] = []
        self._size = 0
        begins = []
        for i, buffer in enumerate(document.get("buffers", [])):
            # Without a file: the chunk, or the place of what is unpacked from other buffers.
            data = self._file(buffer["uri"]) if "uri" in buffer else chunk if i == 0 else b""
            begins.append(self._append(data))
        for view in self._views:
            packed = view.get("extensions", {})
            for place in (view, *(packed[n] for n in packed if n.endswith("_meshopt_compression"))):
                place["byteOffset"] = place.get("byteOffset", 0) + begins[place["buffer"]]
                place["buffer"] = 0
        for image in document.get("images", []):
            uri = image.pop("uri", None)
            if uri is not None:
                image.setdefault("name", "image" if uri.startswith("data:") else unquote(uri))
                self._into_chunk(image, self._file(uri))

    def _file(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        with open(os.path.join(self._folder, unquote(uri)), "rb") as file:
            return file.read()

    def _append(self, data: bytes) -> int:
        begin = self._size
        self._parts.append(data + b"\0" * (-len(data) % 8))
        self._size += len(self._parts[-1])
        return begin

    def _into_chunk(self, image: Dict[str, Any], data: bytes) -> None:
        image["bufferView"] = len(self._views)
        view = {"buffer": 0, "byteOffset": self._append(data), "byteLength": len(data)}
        self._views.append(view)

    def glb(self, library: Any) -> Tuple[bytes, List[str]]:
        document, notes = self._document, []
        images = document["images"]
        data = b"".join(self._parts)
        pngs: Dict[int, Optional[int]] = {}
        for texture in document.get("textures", []):
            basis = texture.get("extensions", {}).pop(_EXTENSION, None)
            if basis is None:
                continue
            source = basis["source"]
            if source not in pngs:
                name = images[source].get("name", f"image {source}")
                view = self._views[images[source]["bufferView"]]
                pngs[source] = None
                try:
                    begin = view["byteOffset"]
                    own = library.open(data[begin : begin + view["byteLength"]])
                    if max(own.width, own.height) > _LARGEST:
                        raise ValueError(f"it is {own.width} x {own.height}")
                    png = _png(own.transcode("rgba8").data)
                except ValueError as error:
                    notes.append(f"the texture {name} is left out: {error}")
                    continue
                pngs[source] = len(images)
                images.append({"name": name})
                self._into_chunk(images[-1], png)
            if pngs[source] is not None:
                texture["source"] = pngs[source]
        for key in ("extensionsUsed", "extensionsRequired"):
            names = [name for name in document.pop(key, []) if name != _EXTENSION]
            if names:
                document[key] = names
        document["buffers"] = [{"byteLength": self._size}]
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        size = 28 + len(text) + self._size
        head = struct.pack("<4s3I4s", _MAGIC, 2, size, len(text), _JSON)
        return b"".join([head, text, struct.pack("<I4s", self._size, _BINARY), *self._parts]), notes


def _png(pixels: Any) -> bytes:
    """Of an array (height, width, 4) of bytes. Alpha that is 255 everywhere is left out."""
    if pixels[..., 3].min() == 255:
        pixels = pixels[..., :3]
    height, width, channels = pixels.shape

    def block(name: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        )

    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    header = struct.pack(">2I5B", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    return b"".join([
        b"\x89PNG\r\n\x1a\n", block(b"IHDR", header),
        block(b"IDAT", zlib.compress(rows, 1)), block(b"IEND", b""),
    ])  # fmt: skip
