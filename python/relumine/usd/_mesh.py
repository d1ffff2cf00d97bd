"""Polygons of USD as triangles with vertices: one vertex for each place with one normal and uvs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom  # type: ignore

from . import _subdivide
from ._notes import Notes

Array = NDArray[Any]
#: A subdivision surface is refined to fewer levels rather than to more faces.
MOST_FACES = 300_000


@dataclass
class Values:
    """values[index] are those of corners; `kind` is point, corner, face or constant."""

    values: Array
    index: Array
    kind: str

    def at(self, corners: Array) -> Array:
        result: Array = self.values[self.index[corners]]
        return result


@dataclass
class Polygons:
    counts: Array
    corners: Array
    points: Array
    normals: Optional[Values]
    primvars: Dict[str, Values]
    #: (F,) the face of the file.
    source: Array
    #: Refined: values of the first `num_points` points are those of the file's points.
    is_refined: bool
    num_points: int
    is_left_handed: bool
    #: (C,) the corner of the file's faces; of no use once refined.
    file_corner: Array
    num_file_corners: int


class Unfit(ValueError):
    """A prim that cannot be drawn, in a few words."""


def _array(attribute: Any, time: Usd.TimeCode, width: int) -> Optional[Array]:
    value = attribute.Get(time) if attribute else None
    if value is None:
        return None
    try:
        array = np.asarray(value, np.float64)
    except (TypeError, ValueError):  # of a type that holds no numbers
        return None
    if array.size == 0:
        return None
    if array.ndim == 0 or not attribute.GetTypeName().isArray:
        array = array.reshape(1, -1)
    return array.reshape(len(array), -1)[:, :width]


def _interpolated(
    values: Array, indices: Optional[Array], kind: str, counts: Array, corners: Array, points: int
) -> Optional[Values]:
    """The values of corners; None where their number does not suit the mesh."""
    num_corners, face = len(corners), np.repeat(np.arange(len(counts)), counts)
    kinds = {
        UsdGeom.Tokens.constant: ("constant", np.zeros(num_corners, np.int64), 1),
        UsdGeom.Tokens.uniform: ("face", face, len(counts)),
        UsdGeom.Tokens.varying: ("point", corners, points),
        UsdGeom.Tokens.vertex: ("point", corners, points),
        UsdGeom.Tokens.faceVarying: ("corner", np.arange(num_corners), num_corners),
    }
    if kind not in kinds:
        return None
    name, places, size = kinds[kind]
    if indices is not None:
        if (
            len(indices) < size
            or indices.min(initial=0) < 0
            or indices.max(initial=0) >= len(values)
        ):
            return None
        places = indices[places]
        if name == "point":
            # Indices may give two points one value, which refining must not see as one point.
            values, places = values[indices], corners
    elif len(values) < size:
        return None
    if not np.isfinite(values).all():
        return None
    return Values(values, places, name)


def primvar(
    prim: Usd.Prim,
    name: str,
    width: int,
    time: Usd.TimeCode,
    counts: Array,
    corners: Array,
    points: int,
    notes: Notes,
) -> Optional[Values]:
    found = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not found or not found.HasValue():
        return None
    values = _array(found.GetAttr(), time, width)
    if values is None or values.shape[1] < width:
        return None
    indices = found.GetIndices(time) if found.IsIndexed() else None
    result = _interpolated(
        values,
        None if indices is None else np.asarray(indices, np.int64),
        found.GetInterpolation(),
        counts,
        corners,
        points,
    )
    if result is None:
        notes.add(f"primvars:{name} does not fit its mesh and is left out", prim.GetPath())
    return result


def _normals(
    prim: Usd.Prim, time: Usd.TimeCode, counts: Array, corners: Array, points: int, notes: Notes
) -> Optional[Values]:
    result = primvar(prim, "normals", 3, time, counts, corners, points, notes)
    if result is None:
        mesh = UsdGeom.PointBased(prim)
        values = _array(mesh.GetNormalsAttr(), time, 3)
        if values is not None:
            result = _interpolated(
                values, None, mesh.GetNormalsInterpolation(), counts, corners, points
            )
            if result is None:
                notes.add("normals do not fit their mesh and are computed", prim.GetPath())
    if result is None or result.kind == "constant":
        return result
    lengths = np.linalg.norm(result.values, axis=1, keepdims=True)
    if (lengths == 0.0).any():
        notes.add("normals of length 0 are computed", prim.GetPath())
        return None
    return Values(result.values / lengths, result.index, result.kind)


def polygons(
    prim: Usd.Prim, time: Usd.TimeCode, wanted: Sequence[Tuple[str, int]], level: int, notes: Notes
) -> Polygons:
    """The faces of a UsdGeomMesh, refined `level` times where it is a subdivision surface.

    wanted  names and widths of primvars
    """
    mesh = UsdGeom.Mesh(prim)
    points = _array(mesh.GetPointsAttr(), time, 3)
    counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get(time) or (), np.int64)
    corners = np.asarray(mesh.GetFaceVertexIndicesAttr().Get(time) or (), np.int64)
    if points is not None and points.shape[1] != 3:
        raise Unfit("has points of other than three numbers")
    if points is None or not len(counts) or not len(corners):
        raise Unfit("has no faces")
    if (counts < 0).any() or counts.sum() != len(corners):
        raise Unfit(f"has faces of {counts.sum()} corners, but {len(corners)} indices")
    if corners.min() < 0 or corners.max() >= len(points):
        raise Unfit(f"has an index beyond its {len(points)} points")
    if not np.isfinite(points).all():
        raise Unfit("has a point that is not finite")
    if np.abs(points).max() > 1e18:
        raise Unfit("has a point farther away than 1e18")
    source = np.arange(len(counts))
    if (counts < 3).any():
        notes.add("faces of fewer than three corners are left out", prim.GetPath())
    scheme_attr = mesh.GetSubdivisionSchemeAttr()
    scheme = scheme_attr.Get(time)
    arguments = (prim, time, counts, corners, len(points), notes)
    normals = None
    if scheme != "none" and not scheme_attr.HasAuthoredValue():
        # The schema's own scheme is Catmull-Clark; exporters that write normals forget to say none.
        normals = _normals(*arguments)
        if normals is not None:
            notes.add(
                "has normals and names no subdivision scheme: taken as polygons", prim.GetPath()
            )
            scheme = "none"
    if scheme == "none" and normals is None:
        normals = _normals(*arguments)
    primvars: Dict[str, Values] = {}
    for name, width in wanted:
        found = primvar(prim, name, width, time, counts, corners, len(points), notes)
        if found is None and width == 2:
            # Blender renames its uvs to st, but not where a texture's transform asks for them.
            found = primvar(prim, "st", width, time, counts, corners, len(points), notes)
            if found is not None:
                notes.add(f"primvars:{name} is not there: st stands for it", prim.GetPath())
        if found is not None:
            primvars[name] = found
    left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    result = Polygons(
        counts, corners, points, normals, primvars, source, scheme != "none", len(points), left_handed,
        np.arange(len(corners)), len(corners),
    )  # fmt: skip
    if scheme != "none":
        _refine(mesh, time, scheme, level, result, notes)
    holes = np.asarray(mesh.GetHoleIndicesAttr().Get(time) or (), np.int64)
    gone = np.isin(result.source, holes) | (result.counts < 3)
    if gone.any():
        _drop(result, gone)
    if not len(result.counts):
        raise Unfit("has no faces")
    if result.normals is None:
        face_normals = newell(result)
        face = np.repeat(np.arange(len(result.counts)), result.counts)
        result.normals = Values(face_normals, face, "face")
    return result


def _drop(mesh: Polygons, gone: Array) -> None:
    keep = np.repeat(~gone, mesh.counts)
    if mesh.normals is not None:
        mesh.normals.index = mesh.normals.index[keep]
    for values in mesh.primvars.values():
        values.index = values.index[keep]
    mesh.corners, mesh.file_corner = mesh.corners[keep], mesh.file_corner[keep]
    mesh.counts, mesh.source = mesh.counts[~gone], mesh.source[~gone]


def _refine(
    mesh: UsdGeom.Mesh, time: Usd.TimeCode, scheme: str, level: int, result: Polygons, notes: Notes
) -> None:
    path = mesh.GetPath()
    if scheme == "loop":
        notes.add("subdivision scheme loop: refined by Catmull and Clark's rules", path)
    small = result.counts < 3
    if small.any():
        _drop(result, small)
    if not len(result.counts):
        raise Unfit("has no faces")
    asked = level
    while level > 0 and len(result.corners) * 4 ** (level - 1) > MOST_FACES:
        level -= 1
    if level < asked:
        notes.add(f"subdivision stops at level {level}, at most {MOST_FACES} faces", path)

    def given(attribute: Any) -> Array:
        return np.asarray(attribute.Get(time) or ())

    lengths = given(mesh.GetCreaseLengthsAttr()).astype(np.int64)
    indices = given(mesh.GetCreaseIndicesAttr()).astype(np.int64)
    sharp = given(mesh.GetCreaseSharpnessesAttr()).astype(float)
    edges: Array = np.zeros((0, 2), np.int64)
    creases: Array = np.zeros(0)
    if len(lengths) and (lengths >= 2).all() and lengths.sum() == len(indices):
        ends = np.cumsum(lengths)
        first = np.setdiff1d(np.arange(len(indices)), ends - 1)
        edges = np.stack([indices[first], indices[first + 1]], 1)
        if len(sharp) == len(lengths):
            creases = np.repeat(sharp, lengths - 1)
        elif len(sharp) == len(edges):
            creases = sharp
        else:
            edges = edges[:0]
    at = given(mesh.GetCornerIndicesAttr()).astype(np.int64)
    how = given(mesh.GetCornerSharpnessesAttr()).astype(float)
    if len(at) != len(how) or (len(at) and (at.min() < 0 or at.max() >= len(result.points))):
        at, how = at[:0], how[:0]
    cage = _subdivide.Cage(
        result.counts, result.corners, result.points, edges, creases, at, how, source=result.source
    )
    for name, values in result.primvars.items():
        if values.kind == "point":
            cage.vertex[name] = values.values
        elif values.kind == "corner":
            given_corners = values.values[values.index]
            cage.face[name] = _subdivide.one_for_each(cage.corners, given_corners)
    boundary = mesh.GetInterpolateBoundaryAttr().Get(time)
    face_varying = mesh.GetFaceVaryingLinearInterpolationAttr().Get(time)
    if boundary == "none" and level > 0:
        notes.add("interpolateBoundary none: its boundary is kept", path)
    for _ in range(level):
        cage = _subdivide.refined(cage, scheme=scheme, boundary=boundary, face_varying=face_varying)
    normals, fans = _subdivide.smooth_normals(cage)
    if result.is_left_handed:
        normals = -normals
    for name, values in result.primvars.items():
        if values.kind == "point":
            result.primvars[name] = Values(cage.vertex[name], cage.corners, "point")
        elif values.kind == "corner":
            result.primvars[name] = Values(*cage.face[name], "corner")
        elif values.kind == "face":
            # (F,) of the file's faces, whatever was dropped.
            faces = np.zeros(int(result.source.max()) + 1, np.int64)
            starts = np.concatenate([[0], np.cumsum(result.counts)[:-1]])
            faces[result.source] = values.index[starts]
            result.primvars[name] = Values(
                values.values, np.repeat(faces[cage.source], cage.counts), "face"
            )
        else:
            zeros = np.zeros(len(cage.corners), np.int64)
            result.primvars[name] = Values(values.values, zeros, "constant")
    result.counts, result.corners, result.points = cage.counts, cage.corners, cage.points
    result.file_corner = np.arange(len(cage.corners))
    result.source = cage.source
    result.normals = Values(normals, fans, "point" if fans is cage.corners else "corner")


def newell(mesh: Polygons) -> Array:
    """(F, 3) unit normals of faces; +Y where a face has no area."""
    following, _, face = _subdivide.next_corner(mesh.counts)
    p = mesh.points[mesh.corners]
    parts = np.cross(p - p[np.repeat(_starts(mesh.counts), mesh.counts)], p[following] - p)
    sums = _subdivide._sum_at(len(mesh.counts), face, parts)
    if mesh.is_left_handed:
        sums = -sums
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(lengths > 0.0, sums / np.where(lengths > 0.0, lengths, 1.0), [0.0, 1.0, 0.0])


def _starts(counts: Array) -> Array:
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)


def triangulated(mesh: Polygons) -> Tuple[Array, Array]:
    """(T, 3) corners of triangles, and (T,) their faces, in the order of faces.

    Quadrangles are cut where both triangles look to the polygon's side; others by their ears.
    """
    starts = _starts(mesh.counts)
    normals = newell(mesh)
    if mesh.is_left_handed:
        normals = -normals
    p = mesh.points[mesh.corners]
    faces: List[Array] = []
    triangles: List[Array] = []
    three = np.flatnonzero(mesh.counts == 3)
    faces.append(three)
    triangles.append(starts[three][:, None] + np.arange(3))

    four = np.flatnonzero(mesh.counts == 4)
    if len(four):
        quad = starts[four][:, None] + np.arange(4)
        a, b, c, d = (p[quad[:, i]] for i in range(4))
        n = normals[four]

        def least(x: Array, y: Array, z: Array, u: Array, v: Array, w: Array) -> Array:
            first = (np.cross(y - x, z - x) * n).sum(1)
            second = (np.cross(v - u, w - u) * n).sum(1)
            smaller: Array = np.minimum(first, second)
            return smaller

        along_ac, along_bd = least(a, b, c, a, c, d), least(a, b, d, b, c, d)
        bd = (along_ac < 0.0) & (along_bd > along_ac)
        cut = np.where(bd[:, None], [0, 1, 3, 1, 2, 3], [0, 1, 2, 0, 2, 3])
        picked = np.take_along_axis(quad, cut, 1).reshape(-1, 3)
        faces.append(np.repeat(four, 2))
        triangles.append(picked)

    many = np.flatnonzero(mesh.counts > 4)
    for face in many:
        count = int(mesh.counts[face])
        corners = starts[face] + np.arange(count)
        cut_list = ears(p[corners], normals[face])
        triangles.append(corners[np.array(cut_list, np.int64)].reshape(-1, 3))
        faces.append(np.full(len(cut_list), face))
    all_faces = np.concatenate(faces)
    order = np.argsort(all_faces, kind="stable")
    result = np.concatenate(triangles)[order]
    if mesh.is_left_handed:
        result = result[:, [0, 2, 1]]
    return result, all_faces[order]


def ears(points: Array, normal: Array) -> List[Tuple[int, int, int]]:
    """Triangles of a polygon: a fan where it is convex, else ears one after the other."""
    axis = np.eye(3)[np.abs(normal).argmin()]
    u = np.cross(axis, normal)
    u /= max(float(np.linalg.norm(u)), 1e-300)
    flat = np.stack([points @ u, points @ np.cross(normal, u)], 1)
    n = len(flat)
    ahead, back = np.roll(flat, -1, 0) - flat, flat - np.roll(flat, 1, 0)
    turn = back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]
    if (turn >= 0.0).all() or n > 2000:
        return [(0, i, i + 1) for i in range(1, n - 1)]

    def area(a: Array, b: Array, c: Array) -> Any:
        return (b[0] - a[0]) * (c[..., 1] - a[1]) - (b[1] - a[1]) * (c[..., 0] - a[0])

    left, result = list(range(n)), []
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            if area(flat[a], flat[b], flat[c]) <= 0.0:
                continue
            others = flat[[k for k in left if k not in (a, b, c)]]
            inside = (
                (area(flat[a], flat[b], others) >= 0.0)
                & (area(flat[b], flat[c], others) >= 0.0)
                & (area(flat[c], flat[a], others) >= 0.0)
            )
            # A polygon with a slit meets itself at points of the same place.
            same = (others[:, None] == flat[[a, b, c]][None]).all(2).any(1)
            if not (inside & ~same).any():
                break
        else:
            i, a, b, c = 0, left[-1], left[0], left[1]
        result.append((a, b, c))
        del left[i]
    result.append((left[0], left[1], left[2]))
    return result


@dataclass
class Vertices:
    """Vertices of some faces: a corner that each was made of, and (T, 3) triangles of them.

    used, vertex  the corners of these faces, and the vertex that each became
    """

    corner: Array
    triangles: Array
    used: Array
    vertex: Array


def split(mesh: Polygons, triangles: Array, names: Sequence[str]) -> Vertices:
    """One vertex for each point with one normal and one value of each primvar."""
    used = np.unique(triangles)
    columns = [mesh.corners[used].astype(np.uint64)]
    assert mesh.normals is not None
    for values in [mesh.normals, *(mesh.primvars[n] for n in names if n in mesh.primvars)]:
        if values.kind in ("point", "constant"):
            continue
        numbers = _subdivide.numbers_of(values.values.astype(np.float32))
        columns.append(numbers[values.index[used]])
    # In the order of points.
    keys = _subdivide.numbers_of(*columns)
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(mesh.corners[used[first]], kind="stable")
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    of_corner = np.zeros(int(used[-1]) + 1, np.int64)
    vertex = place[inverse.reshape(-1)]
    of_corner[used] = vertex
    return Vertices(used[first[order]], of_corner[triangles], used, vertex)
