"""A glTF 2.0 file of arrays: what the reader of meshes takes."""

from __future__ import annotations

import json
import struct
from typing import Any, Dict, List, Optional

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
_FLOAT, _WHOLE = 5126, 5125
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class Glb:
    """Collects nodes, meshes, materials and images. Nodes are drawn in the order of adding."""

    def __init__(self) -> None:
        self.materials: List[Dict[str, Any]] = []
        self._parts: List[bytes] = []
        self._size = 0
        self._lists: Dict[str, List[Any]] = {}
        self._extensions: Dict[str, None] = {}
        self._lights: List[Dict[str, Any]] = []
        self._profiles: List[Dict[str, Any]] = []
        self._vertices: List[int] = []
        #: Of all nodes so far: where the next one's vertices begin in the scene.
        self.num_vertices = 0

    def _add(self, kind: str, item: Dict[str, Any]) -> int:
        items = self._lists.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def _view(self, data: bytes) -> int:
        view = {"buffer": 0, "byteOffset": self._size, "byteLength": len(data)}
        padded = data + b"\0" * (-len(data) % 4)
        self._parts.append(padded)
        self._size += len(padded)
        return self._add("bufferViews", view)

    def _accessor(self, values: Array, kind: int) -> int:
        flat = np.ascontiguousarray(values, np.float32 if kind == _FLOAT else np.uint32)
        width = 1 if flat.ndim == 1 else flat.shape[1]
        accessor: Dict[str, Any] = {
            "bufferView": self._view(flat.tobytes()),
            "componentType": kind,
            "count": len(flat),
            "type": _TYPES[width],
        }
        if kind == _FLOAT and width == 3:
            accessor["min"], accessor["max"] = flat.min(0).tolist(), flat.max(0).tolist()
        return self._add("accessors", accessor)

    def primitive(
        self, attributes: Dict[str, Array], triangles: Array, material: Optional[int]
    ) -> Dict[str, Any]:
        """Arrays of vertices by glTF's names, and (M, 3) indices."""
        primitive: Dict[str, Any] = {
            "attributes": {n: self._accessor(a, _FLOAT) for n, a in attributes.items()},
            "indices": self._accessor(triangles.reshape(-1), _WHOLE),
        }
        if material is not None:
            primitive["material"] = material
        return primitive

    def mesh(self, primitives: List[Dict[str, Any]]) -> int:
        accessors = self._lists["accessors"]
        counts = [accessors[p["attributes"]["POSITION"]]["count"] for p in primitives]
        self._vertices.append(sum(counts))
        return self._add("meshes", {"primitives": primitives})

    def node(self, name: str, matrix: Array, **content: int) -> None:
        """`matrix` (4, 4) multiplies rows of points, as USD's."""
        self._add("nodes", {"name": name, "matrix": matrix.reshape(-1).tolist(), **content})
        if "mesh" in content:
            self.num_vertices += self._vertices[content["mesh"]]

    def punctual(self, light: Dict[str, Any], name: str, matrix: Array) -> None:
        """A light of KHR_lights_punctual."""
        self.use("KHR_lights_punctual")
        self._lights.append(light)
        of_light = {"KHR_lights_punctual": {"light": len(self._lights) - 1}}
        node = {"name": name, "matrix": matrix.reshape(-1).tolist(), "extensions": of_light}
        self._add("nodes", node)

    def profile(self, file: bytes) -> int:
        """A file of LM-63, for profiled()."""
        self.use("EXT_lights_ies")
        view = self._view(file)
        self._profiles.append({"bufferView": view, "mimeType": "application/x-ies-lm-63"})
        return len(self._profiles) - 1

    def profiled(self, light: Dict[str, Any], name: str, matrix: Array) -> None:
        """A light of EXT_lights_ies: index of its profile, multiplier, colour."""
        node = {"name": name, "matrix": matrix.reshape(-1).tolist()}
        self._add("nodes", {**node, "extensions": {"EXT_lights_ies": light}})

    def camera(self, camera: Dict[str, Any]) -> int:
        return self._add("cameras", camera)

    def image(self, data: bytes, kind: str, name: str) -> int:
        return self._add("images", {"bufferView": self._view(data), "mimeType": kind, "name": name})

    def texture(self, image: int, wrap_s: int, wrap_t: int) -> int:
        sampler = self._add("samplers", {"wrapS": wrap_s, "wrapT": wrap_t})
        return self._add("textures", {"source": image, "sampler": sampler})

    def use(self, extension: str) -> None:
        self._extensions[extension] = None

    def bytes(self) -> bytes:
        count = len(self._lists.get("nodes", []))
        document: Dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "relumine.usd"},
            "scene": 0,
            "scenes": [{"nodes": list(range(count))}] if count else [{}],
            **self._lists,
        }
        if self.materials:
            document["materials"] = self.materials
        lights = {"KHR_lights_punctual": self._lights, "EXT_lights_ies": self._profiles}
        of_document = {name: {"lights": own} for name, own in lights.items() if own}
        if of_document:
            document["extensions"] = of_document
        if self._size:
            document["buffers"] = [{"byteLength": self._size}]
        if self._extensions:
            document["extensionsUsed"] = list(self._extensions)
        text = json.dumps(document, allow_nan=False, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        if 28 + len(text) + self._size >= 2**32:
            raise ValueError(
                f"expected a scene below 4 GiB, got {self._size} bytes of meshes and textures"
            )
        chunks = [struct.pack("<II", len(text), 0x4E4F534A), text]
        if self._size:
            chunks += [struct.pack("<II", self._size, 0x004E4942), *self._parts]
        size = 12 + sum(map(len, chunks))
        return b"".join([struct.pack("<III", 0x46546C67, 2, size), *chunks])
