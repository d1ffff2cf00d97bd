"""Meshes."""

from __future__ import annotations

import errno
import json
import os
import warnings
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, Indices, expect, floats, indices, view, whole, word
from ._basis import readable
from ._core import Mesh as CoreMesh
from ._files import FileError, Path, errors, in_python


class RelumineWarning(UserWarning):
    """What a user should know about an input: a mesh, an environment, a precompute."""


def warn(texts: List[str]) -> None:
    for text in texts:
        warnings.warn(in_python(text), RelumineWarning, stacklevel=3)


def saved_mesh(path: Path, core: Union[CoreMesh, _core.Scene]) -> List[str]:
    """Writes a mesh, or a scene's. What to warn of: the file does not hold it."""
    with errors(path):
        left_out = _core.save_mesh(os.fsdecode(path), core)
    return [f"{os.fsdecode(path)}: left out: {what}" for what in left_out]


def _screen_colors(mesh: Any, count: int) -> Optional[NDArray[Any]]:
    """Linear colours of trimesh's visual.vertex_colors or Open3D's vertex_colors."""
    visual = getattr(mesh, "visual", None)
    if visual is not None and getattr(visual, "kind", None) != "vertex":
        return None
    given = np.asarray(getattr(mesh if visual is None else visual, "vertex_colors", ()))
    if given.shape not in ((count, 3), (count, 4)):
        return None
    values = given[:, :3] / (255.0 if given.dtype == np.uint8 else 1.0)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


class Mesh:
    """A triangle mesh. Vertices keep their order and their number; +Y is up.

    vertices   (N, 3), in any unit
    triangles  (M, 3) indices of vertices, counter-clockwise seen from outside
    normals    (N, 3) of unit length; computed from the triangles where not given
    colors     (N, 3) linear RGB
    uvs        (N, 2), for lightmaps
    groups     (M,) names: the things that each triangle is of, for materials and Scene.move()
    blockers   (vertices, triangles) of other things that block the light and are not lit; beside
               groups they are the group "blockers"
    up         "x", "y" or "z": the axis of the arrays that points up
    floor      n: adds a floor of n x n vertices under the mesh, after its own vertices; "auto": a
               coarse one, which precompute() refines where shadows fall
    floor_scale  side of the floor over the mesh's width, or half its height if that is more

    Arrays may have any numeric type, order and byte order; they are converted once. A pickle holds
    them, or the path of the file that was loaded, which is read again. Raises ValueError for other shapes, numbers that are not finite, and indices out of range.

    >>> mesh = relumine.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh
    <relumine.Mesh: 3 vertices, 1 triangles>
    """

    _core: CoreMesh
    #: How to make it again: a function and its arguments.
    _made: Tuple[Callable[..., "Mesh"], Tuple[Any, ...], Dict[str, Any]]
    #: Figures of refined(); empty for any other mesh.
    report: Dict[str, Any]

    def __init__(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: Optional[ArrayLike] = None,
        colors: Optional[ArrayLike] = None,
        uvs: Optional[ArrayLike] = None,
        blockers: Optional[Tuple[ArrayLike, ArrayLike]] = None,
        groups: Optional[Sequence[str]] = None,
        up: str = "y",
        floor: Union[int, str, None] = None,
        floor_scale: float = 4.0,
    ) -> None:
        self.report = {}
        points = floats("vertices", vertices, None, 3)
        count = len(points)
        corners = indices("triangles", triangles, count, None, 3)
        others = None
        if blockers is not None:
            if len(blockers) != 2:
                raise ValueError("blockers: expected (vertices, triangles)")
            corner = floats("blockers[0]", blockers[0], None, 3)
            others = corner, indices("blockers[1]", blockers[1], len(corner), None, 3)
        names = None
        if groups is not None:
            names = [word("groups", name) for name in groups]
            if len(names) != len(corners):
                raise ValueError(
                    f"groups: expected a name for each of {len(corners)} triangles, got {len(names)}"
                )
            distinct = list(dict.fromkeys(names))
            places = {name: place for place, name in enumerate(distinct)}
        self._core = _core.make_mesh(
            points,
            corners,
            None if normals is None else floats("normals", normals, count, 3),
            None if colors is None else floats("colors", colors, count, 3),
            None if uvs is None else floats("uvs", uvs, count, 2),
            others,
            None
            if names is None
            else (distinct, np.array([places[name] for name in names], np.uint32)),
            {"up": up, "floor": floor, "floor_scale": floor_scale},
        )
        given = {"normals": normals, "colors": colors, "uvs": uvs}
        options: Dict[str, Any] = {
            name: None if value is None else np.array(value) for name, value in given.items()
        }
        options.update(blockers=others, groups=names, up=up, floor=floor, floor_scale=floor_scale)
        self._made = Mesh, (points, corners), options

    @classmethod
    def load(
        cls,
        path: Path,
        *,
        up: Optional[str] = None,
        normals: str = "file",
        crease: Optional[float] = None,
        vertex_colors: Optional[str] = None,
        uv_set: Optional[int] = None,
        pose: Optional[str] = None,
        variant: Optional[str] = None,
        floor: Union[int, str, None] = None,
        floor_scale: float = 4.0,
    ) -> "Mesh":
        """Reads an .obj, .gltf, .glb, .ply, .off or .stl file.

        up       the file's axis that points up; by default "z" for .stl, "y" for all others
        normals  "file": the file's where it has them; "smooth": always from the faces
        crease   degrees: normals from the faces, smooth over edges up to this angle; vertices are
                 doubled at sharper ones
        vertex_colors  "srgb" or "linear": what colours of vertices and faces mean; by default sRGB
                 for .obj, .off and bytes of .ply, linear for floats of .ply and for glTF
        uv_set   glTF: the set of uvs that a lightmap takes, n of TEXCOORD_n; by default 1 where it
                 is within 0 to 1 and does not overlap
        pose     glTF: "ANIMATION@SECONDS", the moment in which skins and morph targets stand; None:
                 as the file's nodes say
        variant  glTF: the variant of its materials, by name; None: each surface has its own

        Raises OSError with the file's name.

        >>> relumine.Mesh.load("boulder.ply", floor=20)
        <relumine.Mesh: 7312 vertices, 14070 triangles, floor of 20 x 20>
        """
        options = {
            "up": up,
            "normals": normals,
            "crease": crease,
            "vertex_colors": vertex_colors,
            "uv_set": uv_set,
            "pose": pose,
            "variant": variant,
            "floor": floor,
            "floor_scale": floor_scale,
        }
        with errors(path):
            with readable(os.fsdecode(path)) as (file, notes):
                core = _core.load_mesh(file, options)
        warn([*notes, *core.warnings])
        return cls._of(core, _loaded, os.path.abspath(path), core.source_hash, **options)

    @classmethod
    def of(cls, mesh: Any, **options: Any) -> "Mesh":
        """A mesh of trimesh, of Open3D, or of any object with `vertices` and `faces` or `triangles`;
        or of a file, as load() reads it.

        options  those of Mesh(), or of load() for a file, such as floor="auto"

        Vertex colours are taken as a screen shows them. Normals are computed unless Open3D has
        some. precompute() takes such objects, and names of files, as they are.
        """
        if isinstance(mesh, (str, os.PathLike)):
            return cls.load(mesh, **options)
        if isinstance(mesh, cls):
            if options:
                raise ValueError(f"{next(iter(options))}: expected none beside a relumine.Mesh")
            return mesh
        faces = getattr(mesh, "faces", None)
        triangles = getattr(mesh, "triangles", None) if faces is None else faces
        is_ours = type(mesh).__module__.partition(".")[0] == "relumine"
        if triangles is None or is_ours or not hasattr(mesh, "vertices"):
            hint = "; Mesh.load() reads a file, an array of vertices needs triangles"
            expect("mesh", mesh, cls, "" if is_ours else hint)
        vertices = np.asarray(mesh.vertices)
        colors = _screen_colors(mesh, len(vertices))
        if colors is not None:
            options.setdefault("colors", colors)
        normals = np.asarray(getattr(mesh, "vertex_normals", ()) if faces is None else ())
        if len(normals) == len(vertices):
            options.setdefault("normals", normals)
        return cls(vertices, np.asarray(triangles), **options)

    @classmethod
    def _of(cls, core: CoreMesh, made: Callable[..., "Mesh"], *given: Any, **options: Any) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._core = core
        mesh._made = made, given, options
        mesh.report = {}
        return mesh

    def __deepcopy__(self, memo: Any) -> "Mesh":
        return self

    def __reduce__(self) -> Any:
        return _again, self._made

    def save(self, path: Path) -> None:
        """Writes the mesh: .glb (groups, uvs, materials and images of textures), .obj or .ply.

        A warning names what the format does not hold. The file appears whole or not at all.

        >>> relumine.Mesh.load("boulder.ply").save("boulder.glb")
        """
        warn(saved_mesh(path, self._core))

    @property
    def notes(self) -> List[str]:
        """How the file was read where that is a choice, a line each."""
        return self._core.notes

    @property
    def offset(self) -> Tuple[float, float, float]:
        """What is taken off coordinates that are far from the origin, as those of maps are: (x, y, z).

        `vertices` and all other arrays of places have it taken off. `vertices + offset`, in float64,
        are the file's own. What is given as a single place, such as `eye`, counts as in the file.
        (0, 0, 0) for all other meshes.
        """
        x, y, z = self._core.offset
        return x, y, z

    @property
    def vertices(self) -> Floats:
        """(N, 3) float32, read-only, the floor's included; `offset` is taken off."""
        result: Floats = view(self._core.vertices)
        return result

    @property
    def triangles(self) -> Indices:
        """(M, 3) uint32, read-only."""
        result: Indices = view(self._core.triangles)
        return result

    @property
    def normals(self) -> Floats:
        """(N, 3) float32, read-only; zero for a vertex without a face."""
        result: Floats = view(self._core.normals)
        return result

    @property
    def colors(self) -> Floats:
        """(N, 3) float32, read-only, or (0, 3)."""
        result: Floats = view(self._core.colors)
        return result

    @property
    def uvs(self) -> Floats:
        """(N, 2) float32, read-only, or (0, 2)."""
        result: Floats = view(self._core.uvs)
        return result

    @property
    def materials(self) -> List[Dict[str, Any]]:
        """Materials of the file, as `relumine info --json` tells them: model, colours, roughness,
        names of textures, coat, sheen, film, anisotropy."""
        materials: List[Dict[str, Any]] = json.loads(self._core.materials)
        return materials

    @property
    def groups(self) -> List[str]:
        """Names of the file's objects or groups."""
        return self._core.groups

    @property
    def floor(self) -> int:
        """n of a floor of n x n vertices, 0 without one."""
        return self._core.floor

    def refined(
        self,
        *,
        tolerance: float = 0.01,
        vertices: Optional[int] = None,
        max_edge: Optional[float] = None,
        curved: bool = False,
        progress: Optional[Callable[[float], object]] = None,
    ) -> "Mesh":
        """The mesh with more vertices where its light changes between two of them.

        tolerance  RMS of the transfer, in 1/sr, by which the middle of an edge may differ from the
                   mean of its ends
        vertices   the most that the mesh gets: the edges that matter most are split first
        max_edge   longer edges are split in any case
        curved     new vertices lie on a smooth surface, not in the middle of the old edge

        Vertices keep index and position, but for those of a floor, which follow the new ones. The
        original triangles go on blocking the light. `report` of the result has figures.

        >>> box = relumine.Mesh.load("boulder.ply", floor=2)
        >>> fine = box.refined(tolerance=0.03, vertices=7000)
        >>> len(box.vertices), len(fine.vertices), fine.report["is_at_limit"]
        (6916, 7000, True)
        """
        options: Dict[str, Any] = {
            "tolerance": tolerance,
            "vertices": vertices,
            "max_edge": max_edge,
            "curved": curved,
        }
        for name in ("tolerance", "vertices", "max_edge"):
            value = options[name]
            if value is not None and not value > 0:
                raise ValueError(f"{name}: expected more than 0, got {value}")
        with errors():
            core, report = _core.refined(self._core, options, progress)
        mesh = Mesh._of(core, Mesh.refined, self, **options)
        mesh.report = report
        return mesh

    def simplified(self, num_vertices: int) -> "Mesh":
        """The mesh with fewer vertices, its floor not counted, lit under the full one's shadows.

        >>> relumine.Mesh.load("boulder.ply").simplified(1000)
        <relumine.Mesh: 1000 vertices, 1524 triangles>
        """
        num_vertices = whole("num_vertices", num_vertices, 3, len(self.vertices))
        with errors():
            core = _core.simplified(self._core, num_vertices)
        return Mesh._of(core, Mesh.simplified, self, num_vertices)

    def __repr__(self) -> str:
        floor = f", floor of {self.floor} x {self.floor}" if self.floor else ""
        return (
            f"<relumine.Mesh: {len(self.vertices)} vertices, "
            f"{len(self.triangles)} triangles{floor}>"
        )


def _loaded(path: str, expected_hash: int, **options: Any) -> Mesh:
    """The mesh of a file that was loaded before: what pickles call."""
    mesh = Mesh.load(path, **options)
    if mesh._core.source_hash != expected_hash:
        raise FileError(errno.EINVAL, "expected the file of the pickled mesh, got another", path)
    return mesh


def _again(made: Callable[..., Mesh], given: Tuple[Any, ...], options: Dict[str, Any]) -> Mesh:
    return made(*given, **options)
