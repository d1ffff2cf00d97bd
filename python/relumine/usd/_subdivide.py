"""Subdivision surfaces: Catmull-Clark and bilinear, with creases and corners.

Based on: E. Catmull and J. Clark, "Recursively generated B-spline surfaces on arbitrary topological
meshes", 1978; T. DeRose et al., "Subdivision surfaces in character animation", 1998 (creases, with
the uniform rule). usd-core has no OpenSubdiv, so the rules stand here.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Tuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
#: OpenSubdiv's: what is as sharp as this stays sharp for ever.
INFINITE = 10.0


@dataclass
class Cage:
    """Faces of `counts` corners each; `corners` are indices of points, face by face.

    points    (P, 3); `vertex` has more values of points, smoothed as they are
    face      values of corners (uvs): (V, n), and (C,) which each corner has
    sharp     an edge (a < b) has the sharpness of `creases` where `edges` has it
    source    (F,) the face of the first cage that each is a part of
    """

    counts: Array
    corners: Array
    points: Array
    edges: Array = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    creases: Array = field(default_factory=lambda: np.zeros(0))
    sharp_points: Array = field(default_factory=lambda: np.zeros(0, np.int64))
    corner_sharpness: Array = field(default_factory=lambda: np.zeros(0))
    vertex: Dict[str, Array] = field(default_factory=dict)
    face: Dict[str, Tuple[Array, Array]] = field(default_factory=dict)
    source: Array = field(default_factory=lambda: np.zeros(0, np.int64))


@dataclass
class _Edges:
    ends: Array  # (E, 2), a < b
    of_corner: Array  # (C,) the edge from a corner to the next one
    count: Array  # (E,) faces


def next_corner(counts: Array) -> Tuple[Array, Array, Array]:
    """For each corner: the next and the previous one of its face, and the face."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    face = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(counts.sum()) - starts[face]
    following = starts[face] + (place + 1) % counts[face]
    before = starts[face] + (place - 1) % counts[face]
    return following, before, face


def edges_of(counts: Array, corners: Array) -> _Edges:
    following, _, _ = next_corner(counts)
    other = corners[following]
    low, high = np.minimum(corners, other), np.maximum(corners, other)
    size = int(corners.max()) + 1
    keys, of_corner, count = np.unique(low * size + high, return_inverse=True, return_counts=True)
    return _Edges(np.stack([keys // size, keys % size], 1), of_corner.reshape(-1), count)


def _sum_at(size: int, places: Array, values: Array) -> Array:
    result = np.zeros((size, values.shape[1]))
    for column in range(values.shape[1]):
        result[:, column] = np.bincount(places, values[:, column], size)
    return result


def sharpness(cage: Cage, edges: _Edges) -> Array:
    """(E,) of the edges; boundaries and edges of three faces are infinitely sharp."""
    result = np.zeros(len(edges.ends))
    if len(cage.edges):
        size = int(edges.ends.max()) + 1
        keys = edges.ends[:, 0] * size + edges.ends[:, 1]
        asked = np.sort(cage.edges, axis=1)
        asked_keys = np.where(asked[:, 1] < size, asked[:, 0] * size + asked[:, 1], -1)
        places = np.clip(np.searchsorted(keys, asked_keys), 0, len(keys) - 1)
        found = keys[places] == asked_keys
        np.maximum.at(result, places[found], cage.creases[found])
    result[edges.count != 2] = INFINITE
    return result


def _smoothed(
    counts: Array,
    corners: Array,
    values: Array,
    edges: _Edges,
    sharp: Array,
    corner_sharp: Array,
    bilinear: bool,
) -> Array:
    """Values of old points, then of edges, then of faces, by Catmull and Clark's rules."""
    following, _, face = next_corner(counts)
    of_faces = _sum_at(len(counts), face, values[corners]) / counts[:, None]
    middles = 0.5 * (values[edges.ends[:, 0]] + values[edges.ends[:, 1]])
    if bilinear:
        return np.concatenate([values, middles, of_faces])
    faces_of_edges = _sum_at(len(edges.ends), edges.of_corner, of_faces[face])
    smooth = 0.5 * middles + 0.25 * faces_of_edges
    weight = np.clip(sharp, 0.0, 1.0)[:, None]
    of_edges = np.where(weight >= 1.0, middles, (1.0 - weight) * smooth + weight * middles)

    n = len(values)
    a, b = edges.ends.T
    both, others = np.concatenate([a, b]), np.concatenate([b, a])
    valence = np.bincount(both, minlength=n)
    divisor = np.maximum(valence, 1)[:, None]
    mean_face = _sum_at(n, corners, of_faces[face])
    num_faces = np.maximum(np.bincount(corners, minlength=n), 1)[:, None]
    mean_face /= num_faces
    mean_edge = _sum_at(n, both, np.concatenate([middles, middles])) / divisor
    rounded = (mean_face + 2.0 * mean_edge + (divisor - 3.0) * values) / divisor

    # On a crease: six parts of itself, one of each neighbour along it.
    is_sharp = np.concatenate([sharp, sharp]) > 0.0
    num_sharp = np.bincount(both[is_sharp], minlength=n)
    along = _sum_at(n, both[is_sharp], values[others[is_sharp]])
    creased = (6.0 * values + along) / 8.0
    mean_sharp = np.bincount(both, np.concatenate([sharp, sharp]), n)
    mean_sharp = mean_sharp / np.maximum(num_sharp, 1)
    on_crease = np.clip(mean_sharp, 0.0, 1.0)[:, None]
    result = np.where(
        (num_sharp == 2)[:, None], (1.0 - on_crease) * rounded + on_crease * creased, rounded
    )
    fixed = np.where(num_sharp >= 3, mean_sharp, 0.0)
    fixed = np.clip(np.maximum(fixed, corner_sharp), 0.0, 1.0)[:, None]
    result = np.where(fixed > 0.0, (1.0 - fixed) * result + fixed * values, result)
    result[valence == 0] = values[valence == 0]
    return np.concatenate([result, of_edges, of_faces])


def refined(cage: Cage, *, scheme: str, boundary: str, face_varying: str) -> Cage:
    """One level: each face of n corners becomes n faces of four. Old points keep their numbers."""
    bilinear = scheme == "bilinear"
    edges = edges_of(cage.counts, cage.corners)
    sharp = sharpness(cage, edges)
    n, num_edges = len(cage.points), len(edges.ends)
    corner_sharp = np.zeros(n)
    np.maximum.at(corner_sharp, cage.sharp_points, cage.corner_sharpness)
    if boundary == "edgeAndCorner":
        corner_sharp[np.bincount(cage.corners, minlength=n) == 1] = INFINITE

    _, before, face = next_corner(cage.counts)
    corners = np.stack(
        [
            cage.corners,
            n + edges.of_corner,
            n + num_edges + face,
            n + edges.of_corner[before],
        ],
        axis=1,
    ).reshape(-1)

    def apply(values: Array) -> Array:
        return _smoothed(cage.counts, cage.corners, values, edges, sharp, corner_sharp, bilinear)

    # Halves of a crease that is still sharp, by one less.
    still = (sharp > 1.0) & (edges.count == 2)
    middle = n + np.flatnonzero(still)
    halves = np.concatenate([np.stack([edges.ends[still, i], middle], 1) for i in (0, 1)]).reshape(
        -1, 2
    )
    left = sharp[still]
    left = np.where(left >= INFINITE, left, left - 1.0)
    keep = cage.corner_sharpness > 1.0
    kept = cage.corner_sharpness[keep]
    return Cage(
        counts=np.full(len(cage.corners), 4),
        corners=corners,
        points=apply(cage.points),
        edges=halves,
        creases=np.concatenate([left, left]),
        sharp_points=cage.sharp_points[keep],
        corner_sharpness=np.where(kept >= INFINITE, kept, kept - 1.0),
        vertex={name: apply(values) for name, values in cage.vertex.items()},
        face={
            name: _face_values(cage, own, index, before, face, bilinear, face_varying)
            for name, (own, index) in cage.face.items()
        },
        source=cage.source[face],
    )


def numbers_of(*columns: Array) -> Array:
    """A number for each row of arrays: equal rows have equal numbers, others as good as never.

    Sorting numbers is some thirty times faster than sorting rows.
    """
    result = np.zeros(len(columns[0]), np.uint64)
    for column in columns:
        rows = np.ascontiguousarray(column.reshape(len(column), -1))
        if rows.dtype.kind == "f":
            rows = rows + 0.0  # -0 is 0
        for word in rows.view(np.uint32).T.astype(np.uint64):
            result = (result ^ word) * np.uint64(0x9E3779B97F4A7C15)
            result ^= result >> np.uint64(29)
    return result


def one_for_each(points: Array, values: Array) -> Tuple[Array, Array]:
    """Values of corners, each once for each point that has it, and which each corner has."""
    keys = numbers_of(points.astype(np.float64), values)
    _, index, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return values[index], inverse.reshape(-1)


def _face_values(
    cage: Cage,
    own: Array,
    index: Array,
    before: Array,
    face: Array,
    bilinear: bool,
    rule: str,
) -> Tuple[Array, Array]:
    """Values of corners: a mesh of their own, whose boundaries are the seams."""
    edges = edges_of(cage.counts, index)
    sharp = np.where(edges.count != 2, INFINITE, 0.0)
    corner_sharp = np.zeros(len(own))
    linear = bilinear or rule == "all"
    if not linear and rule != "none":
        # All other rules keep the corners of seams.
        is_corner = np.bincount(index, minlength=len(own)) == 1
        corner_sharp[is_corner] = INFINITE
        ends = edges.ends[sharp > 0.0].reshape(-1)
        if rule in ("cornersPlus1", "cornersPlus2", "boundaries"):
            corner_sharp[np.bincount(ends, minlength=len(own)) > 2] = INFINITE
        if rule == "boundaries":
            corner_sharp[ends] = INFINITE
    new = _smoothed(cage.counts, index, own, edges, sharp, corner_sharp, linear)
    n, num_edges = len(own), len(edges.ends)
    corners = np.stack(
        [index, n + edges.of_corner, n + num_edges + face, n + edges.of_corner[before]], axis=1
    )
    return new, corners.reshape(-1)


def smooth_normals(cage: Cage) -> Tuple[Array, Array]:
    """Normals, smooth over all edges that are not sharp, and (C,) which a corner has."""
    following, before, face = next_corner(cage.counts)
    p = cage.points[cage.corners]
    ahead, back = p[following] - p, p[before] - p
    normal = np.cross(ahead, back)
    length = np.linalg.norm(normal, axis=1)
    lengths = np.linalg.norm(ahead, axis=1) * np.linalg.norm(back, axis=1)
    angle = np.arctan2(length, (ahead * back).sum(1))
    weighted = normal * (angle / np.where(length > 0.0, length, 1.0))[:, None]
    weighted[lengths == 0.0] = 0.0

    edges = edges_of(cage.counts, cage.corners)
    sharp = sharpness(cage, edges)
    fan = _fans(cage, edges, sharp, following)
    sums = _sum_at(int(fan.max()) + 1 if len(fan) else 0, fan, weighted)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return sums / np.where(lengths > 0.0, lengths, 1.0), fan


def _fans(cage: Cage, edges: _Edges, sharp: Array, following: Array) -> Array:
    """(C,) corners of one point with no sharp edge between them have one number."""
    if not ((sharp > 0.0) & (edges.count == 2)).any():
        # Boundaries part no faces.
        return cage.corners
    order = np.argsort(edges.of_corner, kind="stable")
    edge = edges.of_corner[order]
    pairs = np.flatnonzero((edge[1:] == edge[:-1]) & (sharp[edge[1:]] == 0.0))
    c, d = order[pairs], order[pairs + 1]
    # Two faces run along their edge in opposite directions, unless they are not wound alike.
    opposite = cage.corners[c] == cage.corners[following[d]]
    links = np.concatenate(
        [
            np.stack([c, np.where(opposite, following[d], d)], 1),
            np.stack([following[c], np.where(opposite, d, following[d])], 1),
        ]
    )
    label = np.arange(len(cage.corners))
    while True:
        least = np.minimum(label[links[:, 0]], label[links[:, 1]])
        new = label.copy()
        np.minimum.at(new, links[:, 0], least)
        np.minimum.at(new, links[:, 1], least)
        new = new[new]
        if (new == label).all():
            break
        label = new
    fans: Array = np.unique(label, return_inverse=True)[1].reshape(-1)
    return fans
