"""Cubes, spheres, cylinders, cones, capsules and planes as polygons."""

from __future__ import annotations

from typing import Any, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom  # type: ignore

from ._mesh import Polygons, Unfit, Values

Array = NDArray[Any]
SIDES = 48


def _profile(rz: Array, nrz: Array) -> Tuple[Array, Array, Array, Array]:
    """A surface around +Z: radii and heights (K, 2), and normals in their plane (K, 2)."""
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    c, s = np.cos(angle), np.sin(angle)

    def around(values: Array) -> Array:
        r, z = values[:, :1], values[:, 1:]
        flat = np.stack([r * c, r * s, np.broadcast_to(z, (len(z), SIDES))], -1)
        points: Array = flat.reshape(-1, 3)
        return points

    i = np.arange(SIDES)
    j = (i + 1) % SIDES
    counts, corners = [], []
    for k in range(len(rz) - 1):
        ring = [k * SIDES + i, k * SIDES + j, (k + 1) * SIDES + j, (k + 1) * SIDES + i]
        # Poles are points: their faces have three corners.
        if rz[k, 0] == 0.0:
            del ring[1]
        elif rz[k + 1, 0] == 0.0:
            del ring[2]
        counts.append(np.full(SIDES, len(ring)))
        corners.append(np.stack(ring, -1).reshape(-1))
    return around(rz), around(nrz), np.concatenate(counts), np.concatenate(corners)


def _circle_part(low: float, high: float, steps: int) -> Array:
    """Points of a circle from an angle to another, from the equator, as (r, z)."""
    angle = np.radians(np.linspace(low, high, steps + 1))
    result: Array = np.stack([np.cos(angle), np.sin(angle)], 1)
    result[np.abs(result) < 1e-12] = 0.0
    return result


def _turned(points: Array, axis: str) -> Array:
    """From +Z to another axis, by a turn."""
    order = {"X": [2, 0, 1], "Y": [1, 2, 0], "Z": [0, 1, 2]}[axis]
    return points[:, order]


def _joined(parts: List[Tuple[Array, Array, Array, Array]]) -> Tuple[Array, Array, Array, Array]:
    points, normals, counts, corners = [], [], [], []
    first = 0
    for p, n, count, corner in parts:
        points.append(p)
        normals.append(n)
        counts.append(count)
        corners.append(corner + first)
        first += len(p)
    return (
        np.concatenate(points),
        np.concatenate(normals),
        np.concatenate(counts),
        np.concatenate(corners),
    )


def _cap(radius: float, z: float, up: float) -> Tuple[Array, Array, Array, Array]:
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(SIDES, z)], 1)
    normals = np.broadcast_to([0.0, 0.0, up], (SIDES, 3))
    corners = np.arange(SIDES) if up > 0.0 else np.arange(SIDES)[::-1]
    return points, normals, np.array([SIDES]), corners


def shape(prim: Usd.Prim, time: Usd.TimeCode) -> Optional[Polygons]:
    """The polygons of a prim of UsdGeom that has a formula; None for any other."""

    def number(name: str) -> float:
        value = float(prim.GetAttribute(name).Get(time))
        if not np.isfinite(value):
            raise Unfit(f"has {name} {value}")
        return value

    axis = "Z"
    if prim.IsA(UsdGeom.Sphere):
        ball = _circle_part(-90, 90, SIDES // 2)
        points, normals, counts, corners = _profile(ball * number("radius"), ball)
    elif prim.IsA(UsdGeom.Cube):
        h = 0.5 * number("size")
        faces: List[Tuple[Array, Array, Array, Array]] = []
        for k in range(3):
            for sign in (-1.0, 1.0):
                n = np.eye(3)[k] * sign
                u, v = np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3] * sign
                square = np.array([n - u - v, n + u - v, n + u + v, n - u + v]) * h
                faces.append((square, np.broadcast_to(n, (4, 3)), np.array([4]), np.arange(4)))
        points, normals, counts, corners = _joined(faces)
    elif prim.IsA(UsdGeom.Cylinder) or prim.IsA(UsdGeom.Cone):
        axis = prim.GetAttribute("axis").Get(time)
        radius, half = number("radius"), 0.5 * number("height")
        top = 0.0 if prim.IsA(UsdGeom.Cone) else radius
        slope = np.array([2.0 * half, radius - top])
        slope /= max(float(np.linalg.norm(slope)), 1e-300)
        side = _profile(np.array([[radius, -half], [top, half]]), np.stack([slope, slope]))
        parts = [side, _cap(radius, -half, -1.0)]
        if top > 0.0:
            parts.append(_cap(top, half, 1.0))
        points, normals, counts, corners = _joined(parts)
    elif prim.IsA(UsdGeom.Capsule):
        axis = prim.GetAttribute("axis").Get(time)
        radius, half = number("radius"), 0.5 * number("height")
        low, high = _circle_part(-90, 0, SIDES // 4), _circle_part(0, 90, SIDES // 4)
        rz = np.concatenate([low * radius - [0, half], high * radius + [0, half]])
        points, normals, counts, corners = _profile(rz, np.concatenate([low, high]))
    elif prim.IsA(UsdGeom.Plane):
        axis = prim.GetAttribute("axis").Get(time)
        w, l = 0.5 * number("width"), 0.5 * number("length")
        # The width is along X, or along Z where the axis is X; the length along Y, or Z for Y.
        if axis == "X":
            points = np.array([[0, -l, w], [0, -l, -w], [0, l, -w], [0, l, w]], float)
        elif axis == "Y":
            points = np.array([[-w, 0, l], [w, 0, l], [w, 0, -l], [-w, 0, -l]], float)
        else:
            points = np.array([[-w, -l, 0], [w, -l, 0], [w, l, 0], [-w, l, 0]], float)
        normals = np.broadcast_to(np.eye(3)["XYZ".index(axis)], (4, 3))
        counts, corners, axis = np.array([4]), np.arange(4), "Z"
    else:
        return None
    points, normals = _turned(points, axis), _turned(np.asarray(normals), axis)
    left = UsdGeom.Gprim(prim).GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return Polygons(
        counts,
        corners,
        points,
        Values(normals, corners, "point"),
        {},
        np.arange(len(counts)),
        False,
        len(points),
        left,
        np.arange(len(corners)),
        len(corners),
    )
