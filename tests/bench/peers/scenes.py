"""Scenes as every peer gets them: plain dictionaries of numbers and arrays, in Relumine's world.

The world is right-handed, +Y is up, and colours are linear. A scene is {"shapes", "camera",
"light", "bounces"}:

shape    {"vertices": (N, 3), "triangles": (M, 3), "normals": (N, 3) or None, "material"}
material {"kind": "matte", "metal", "glossy" or "glass", "color": (r, g, b), "roughness", "ior",
          "coat": 0..1, "sheen": (r, g, b), "glow": (r, g, b)}; roughness is glTF's: alpha = its square
camera   {"eye", "target", "fov": vertical degrees, "size": pixels of the square picture}
light    {"dome": (H, 2 H, 3) lat-long as Relumine reads it, "turn": (3, 3) from the picture's
          directions to the world's, "regions": [{"direction", "degrees", "factor"}], discs of the
          world's directions where the dome is brighter, "suns": [{"direction", "irradiance"}],
          "lamps": [{"position", "intensity"}]}; suns and lamps have no size, intensity is power per sr
bounces  how often light goes on after the surface that the eye sees; None: until nothing is left
"""
import math

import numpy as np


def array(data, kind, shape):
    """An array of what it consists of: how worker.py sends them."""
    return np.frombuffer(data, kind).reshape(shape)


def material(kind="matte", color=(0.5, 0.5, 0.5), **others):
    """A material; what is not said is as glTF has it."""
    plain = {"roughness": 0.5, "ior": 1.5, "coat": 0.0, "sheen": (0.0, 0.0, 0.0), "sheen_roughness": 0.5, "glow": (0.0, 0.0, 0.0)}
    return {"kind": kind, "color": tuple(color), **plain, **others}


def shape(vertices, triangles, surface, normals=None):
    return {
        "vertices": np.asarray(vertices, float),
        "triangles": np.asarray(triangles, np.int64),
        "normals": None if normals is None else np.asarray(normals, float),
        "material": surface,
    }


def sphere(radius, centre, surface, rings=96):
    """A sphere of rings x 2 rings quadrilaterals, with the normals of the true one."""
    theta = np.linspace(0, math.pi, rings + 1)[:, None]
    phi = np.linspace(0, 2 * math.pi, 2 * rings + 1)[None, :]
    normals = np.stack(
        [np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.cos(phi)], axis=-1
    ).reshape(-1, 3)
    row = 2 * rings + 1
    corner = (np.arange(rings)[:, None] * row + np.arange(2 * rings)[None, :]).ravel()
    upper = np.stack([corner, corner + row, corner + row + 1], axis=1)
    lower = np.stack([corner, corner + row + 1, corner + 1], axis=1)
    # Those at the poles have no area.
    triangles = np.concatenate([upper[: -2 * rings], lower[2 * rings :]])
    return shape(radius * normals + np.asarray(centre, float), triangles, surface, normals)


def quad(corner, side, other, surface, steps=1):
    """A rectangle of steps x steps squares that faces cross(side, other)."""
    corner, side, other = (np.asarray(each, float) for each in (corner, side, other))
    s, t = np.meshgrid(np.linspace(0, 1, steps + 1), np.linspace(0, 1, steps + 1), indexing="ij")
    vertices = corner + s[..., None] * side + t[..., None] * other
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)[None, :]).ravel()
    triangles = np.concatenate(
        [np.stack([first, first + steps + 1, first + steps + 2], 1), np.stack([first, first + steps + 2, first + 1], 1)]
    )
    return shape(vertices.reshape(-1, 3), triangles, surface)


def cube(half, surface):
    """A cube about the origin, its faces looking out."""
    faces = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            a, b = np.zeros(3), np.zeros(3)
            a[(axis + 1) % 3], b[(axis + 2) % 3] = 2 * half, 2 * half * sign
            middle = np.zeros(3)
            middle[axis] = sign * half
            faces.append(quad(middle - a / 2 - b / 2, a, b, surface))
    return faces


def camera(eye, target, fov, size):
    return {"eye": tuple(map(float, eye)), "target": tuple(map(float, target)), "fov": float(fov), "size": int(size)}


def axes_of(view):
    """(right, up, back) of a camera, unit vectors; up is +Y, or +Z where it looks along Y."""
    back = np.asarray(view["eye"], float) - np.asarray(view["target"], float)
    back /= np.linalg.norm(back)
    upright = np.array([0.0, 1.0, 0.0]) if abs(back[1]) < 0.999 else np.array([0.0, 0.0, 1.0])
    right = np.cross(upright, back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right), back


def rays_of(view, per_axis=1, random=None):
    """(origin, directions (S, S, 3)) with S = size * per_axis: those through the middles of subpixels, or anywhere in them."""
    right, up, back = axes_of(view)
    count = view["size"] * per_axis
    within = np.full((2, count, count), 0.5) if random is None else random.uniform(0, 1, (2, count, count))
    rows, columns = ((np.indices((count, count)) + within) / count * 2 - 1) * math.tan(math.radians(view["fov"]) / 2)
    directions = columns[..., None] * right - rows[..., None] * up - back
    return np.asarray(view["eye"], float), directions / np.linalg.norm(directions, axis=2, keepdims=True)


def dome_directions(height):
    """(H, 2 H, 3): where the pixels of a lat-long look: u = 1/2 - atan2(x, z) / 2 pi."""
    theta = (np.arange(height) + 0.5) / height * math.pi
    phi = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2 * math.pi
    s = np.sin(theta)[:, None]
    return np.stack([s * np.sin(phi), np.cos(theta)[:, None] + 0 * phi, s * np.cos(phi)], axis=-1)


#: A soft light of another colour near every axis, and one between them: every mirror image differs.
LOBES = [
    ((1, 0.1, 0), (3, 0, 0)), ((-1, 0, 0.1), (0, 3, 0)), ((0.1, 1, 0), (0, 0, 3)),
    ((0, -1, 0.1), (2, 2, 0)), ((0, 0.1, 1), (0, 2, 2)), ((0.1, 0, -1), (2, 0, 2)), ((1, 1, 1), (2, 2, 2)),
]  # fmt: skip


def lobes(directions, turn=None, sharpness=12.0):
    """The radiance of LOBES in some directions, (..., 3), turned about by a matrix."""
    light = np.full((*directions.shape[:-1], 3), 0.1)
    for axis, color in LOBES:
        axis = np.asarray(axis, float) / np.linalg.norm(axis)
        axis = axis if turn is None else turn @ axis
        light += np.exp(sharpness * (directions @ axis - 1))[..., None] * np.asarray(color, float)
    return light


def lobe_irradiance(normal, turn=None):
    """The irradiance of LOBES on a surface, by 2 million directions."""
    directions = dome_directions(1024)
    theta = (np.arange(1024) + 0.5) / 1024 * math.pi
    weight = np.sin(theta)[:, None] * (math.pi / 1024) ** 2 * np.maximum(directions @ np.asarray(normal, float), 0)
    return (lobes(directions, turn) * weight[..., None]).sum((0, 1))


def turn_about(axis, degrees):
    """The rotation matrix about an axis, by the right hand."""
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


def light(dome=None, turn=None, suns=(), lamps=(), regions=()):
    return {
        "dome": None if dome is None else np.asarray(dome, np.float32),
        "turn": np.eye(3) if turn is None else turn,
        "regions": list(regions),
        "suns": list(suns),
        "lamps": list(lamps),
    }


def dome_of(shine):
    """The dome of a light with its regions in it."""
    if not shine["regions"]:
        return shine["dome"]
    dome = shine["dome"].copy()
    directions = dome_directions(len(dome)) @ np.asarray(shine["turn"]).T
    for region in shine["regions"]:
        axis = np.asarray(region["direction"], float) / np.linalg.norm(region["direction"])
        dome[directions @ axis > math.cos(math.radians(region["degrees"]))] *= region["factor"]
    return dome


def scene(shapes, view, shine, bounces=0):
    return {"shapes": shapes, "camera": view, "light": shine, "bounces": bounces}
