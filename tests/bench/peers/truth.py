"""Truth: does every peer show what a closed form says, and where there is none, what the others show?"""
import math
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import scenes

WHITE = np.ones((16, 32, 3), np.float32)
FAR = scenes.camera((0, 0, 5), (0, 0, 0), 15, 8)


def ball(kind="matte", color=(1, 1, 1), **others):
    return [scenes.sphere(1, (0, 0, 0), scenes.material(kind, color, **others), 32)]


def furnace(shapes, bounces=0):
    """The mean of what lies well within the ball under a white sky: 1."""
    return scenes.scene(shapes, FAR, scenes.light(WHITE), bounces), lambda picture: [picture.mean()], [1.0]


def sun_on_ball():
    """A ball on a plane under a sun, each pixel's brightness against the closed form: their mean, and L2."""
    radius, albedo, size = 0.6, 0.5, 32
    matte = scenes.material(color=(albedo,) * 3)
    shapes = [scenes.sphere(radius, (0, radius, 0), matte, 64), scenes.quad((-3, 0, -3), (0, 0, 6), (6, 0, 0), matte, 24)]
    view = scenes.camera((1, 4, 3), (0.2, 0.3, 0), 30, size)
    towards = np.array([0.5, 1.0, 0.3]) / np.linalg.norm([0.5, 1.0, 0.3])
    origin, rays = scenes.rays_of(view, 8)
    centre = np.array([0, radius, 0])

    def distance(start, along):
        b = ((start - centre) * along).sum(-1)
        inside = b**2 - ((start - centre) ** 2).sum(-1) + radius**2
        return np.where(inside > 0, -b - np.sqrt(np.maximum(inside, 0)), -1)

    ball_at = distance(origin, rays)
    plane_at = -origin[1] / rays[..., 1]
    on_ball = (ball_at > 0) & (ball_at < plane_at)
    point = origin + np.where(on_ball, ball_at, plane_at)[..., None] * rays
    normal = np.where(on_ball[..., None], (point - centre) / radius, [0.0, 1.0, 0.0])
    lit = np.maximum((normal * towards).sum(-1), 0) * (on_ball | (distance(point, towards) < 0))
    wanted = (albedo * lit).reshape(size, 8, size, 8).mean((1, 3))
    shine = scenes.light(suns=[{"direction": towards.tolist(), "irradiance": (math.pi,) * 3}])

    def measure(picture):
        shown = picture.mean(2)
        return [shown.mean() / wanted.mean(), 1 + np.linalg.norm(shown - wanted) / np.linalg.norm(wanted)]

    return scenes.scene(shapes, view, shine), measure, [1.0, 1.0]


def lamp(steps):
    floor = scenes.quad((-1, 0, -1), (0, 0, 2), (2, 0, 0), scenes.material(), steps)
    shine = scenes.light(lamps=[{"position": (0, 2, 0), "intensity": (1, 1, 1)}])
    return scenes.scene([floor], scenes.camera((0, 5, 0), (0, 0, 0), 1, 4), shine), lambda picture: [picture.mean()], [0.5 / math.pi / 4]


def panel():
    """A glowing square of side 1, 1 above a floor: what is below its middle."""
    a = 0.5
    factor = 4 / math.pi * (a / math.sqrt(1 + a * a)) * math.atan(a / math.sqrt(1 + a * a))
    floor = scenes.quad((-1, 0, -1), (0, 0, 2), (2, 0, 0), scenes.material(), 16)
    above = scenes.quad((-a, 1, -a), (1, 0, 0), (0, 0, 1), scenes.material(color=(0, 0, 0), glow=(3, 3, 3)))
    view = scenes.camera((0.8, 0.9, 0), (0, 0, 0), 1, 4)
    return scenes.scene([floor, above], view, scenes.light()), lambda picture: [picture.mean()], [0.5 * 3 * factor]


def dome(turn, sign):
    """Three faces of a white cube under a dome of coloured lobes, in nine numbers."""
    view = scenes.camera((4 * sign, 4 * sign, 4 * sign), (0, 0, 0), 14, 24)
    origin, rays = scenes.rays_of(view)
    entry = (0.5 * sign - origin[0]) / rays  # where each ray meets the planes of the three faces
    points = origin + entry.max(-1)[..., None] * rays
    face = entry.argmax(-1)
    within = np.sort(np.abs(points), axis=-1)[..., 1] < 0.42
    masks = [within & (face == axis) for axis in range(3)]
    wanted = [scenes.lobe_irradiance(sign * np.eye(3)[axis], turn) / math.pi for axis in range(3)]
    shine = scenes.light(scenes.lobes(scenes.dome_directions(128)), turn)
    shapes = scenes.cube(0.5, scenes.material(color=(1, 1, 1)))

    def measure(picture):
        return np.concatenate([picture[mask].mean(0) for mask in masks])

    return scenes.scene(shapes, view, shine), measure, np.concatenate(wanted)


def shiny(kind, **others):
    """A ball under the dome of lobes: no closed form, the picture's colours in four quarters."""
    shine = scenes.light(scenes.lobes(scenes.dome_directions(128)))

    def measure(picture):
        half = len(picture) // 2
        return np.concatenate([picture[y : y + half, x : x + half].mean((0, 1)) for y in (0, half) for x in (0, half)])

    view = scenes.camera((0, 0, 5), (0, 0, 0), 15, 16)
    return scenes.scene(ball(kind, others.pop("color", (1, 1, 1)), **others), view, shine), measure, None


def box(bounces):
    """A room with an open side, seen through it: the means of its nine fields. Direct light is integrated over the opening."""
    albedo = 0.7
    matte = scenes.material(color=(albedo,) * 3)
    walls = [
        scenes.quad((-1, 0, -1), (0, 0, 2), (2, 0, 0), matte, 20), scenes.quad((-1, 2, -1), (2, 0, 0), (0, 0, 2), matte, 20),
        scenes.quad((-1, 0, -1), (2, 0, 0), (0, 2, 0), matte, 20), scenes.quad((-1, 0, -1), (0, 2, 0), (0, 0, 2), matte, 20),
        scenes.quad((1, 0, -1), (0, 0, 2), (0, 2, 0), matte, 20),
    ]  # fmt: skip
    view = scenes.camera((0, 1, 3.5), (0, 1, 0), 40, 12)

    def measure(picture):
        return picture.reshape(3, len(picture) // 3, 3, len(picture) // 3, 3).mean((1, 3, 4)).ravel()

    wanted = measure(albedo / math.pi * through_opening(view)) if bounces == 0 else None
    return scenes.scene(walls, view, scenes.light(scenes.lobes(scenes.dome_directions(256))), bounces), measure, wanted


def through_opening(view, per_axis=12, steps=32):
    """The irradiance of what a ray in each subpixel meets in box(), by squares of its open side."""
    origin, rays = scenes.rays_of(view, per_axis, np.random.default_rng(1))
    normals = np.array([[0, 1, 0], [0, -1, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0]], float)
    places = np.array([0, -2, -1, -1, -1], float)  # normals @ point on each wall
    towards = rays @ normals.T
    along = np.where(towards < 0, (places - normals @ origin) / np.minimum(towards, -1e-12), np.inf)
    wall = along.argmin(-1)
    points = origin + along.min(-1)[..., None] * rays
    middles = (np.arange(steps) + 0.5) / steps * 2
    opening = np.stack([*np.meshgrid(middles - 1, middles, indexing="ij"), np.ones((steps, steps))], axis=-1)
    light = np.empty(rays.shape)
    for row in range(len(rays)):
        ways = opening - points[row][:, None, None]
        square = (ways**2).sum(-1)
        ways /= np.sqrt(square)[..., None]
        facing = np.maximum(np.einsum("pijk,pk->pij", ways, normals[wall[row]]), 0)
        light[row] = (scenes.lobes(ways) * (facing * ways[..., 2] / square)[..., None]).sum((1, 2)) * (2 / steps) ** 2
    return light


#: Row: its scene, and samples a pixel.
ROWS = {
    "white furnace, matte": (lambda: furnace(ball()), 256),
    "metal, roughness 0.1": (lambda: furnace(ball("metal", roughness=0.1)), 256),
    "metal, roughness 0.3": (lambda: furnace(ball("metal", roughness=0.3)), 256),
    "metal, roughness 0.6": (lambda: furnace(ball("metal", roughness=0.6)), 256),
    "metal, roughness 1": (lambda: furnace(ball("metal", roughness=1.0)), 256),
    "white under a highlight, roughness 0.5": (lambda: furnace(ball("glossy")), 256),
    "the same under a clear coat": (lambda: furnace(ball("glossy", coat=1.0)), 256),
    "white sheen over white": (lambda: furnace(ball("matte", sheen=(1, 1, 1))), 256),
    "glass": (lambda: furnace(ball("glass"), None), 256),
    "sun on a ball and its shadow: mean, 1 + L2": (sun_on_ball, 64),
    "lamp of 1 W/sr over a fine floor": (lambda: lamp(32), 16),
    "the same over two triangles": (lambda: lamp(1), 16),
    "glowing panel": (panel, 1024),
    "dome as it lies": (lambda: dome(None, 1), 1024),
    "its other side": (lambda: dome(None, -1), 1024),
    "dome turned by 40 degrees about X": (lambda: dome(scenes.turn_about((1, 0, 0), 40), 1), 1024),
    "about Y": (lambda: dome(scenes.turn_about((0, 1, 0), 40), 1), 1024),
    "about Z": (lambda: dome(scenes.turn_about((0, 0, 1), 40), 1), 1024),
    "metal of roughness 0.3 under coloured lights": (lambda: shiny("metal", roughness=0.3), 512),
    "highlight of roughness 0.3 on black": (lambda: shiny("glossy", color=(0, 0, 0), roughness=0.3), 512),
    "glass ball under coloured lights": (lambda: shiny("glass"), 1024),
    "open room, direct": (lambda: box(0), 8192),
    "open room, one bounce": (lambda: box(1), 8192),
    "open room, all bounces": (lambda: box(None), 8192),
}


def run(peers, quick, rows=None):
    """Prints a table of ratios to the closed form, or to the peers' median where there is none."""
    print("\n### Truth\n\n| scene | against | " + " | ".join(peer.name for peer in peers) + " |\n" + "|---" * (len(peers) + 2) + "|")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name in rows or ROWS:
            make, samples = ROWS[name]
            scene, measure, wanted = make()
            drawn = list(pool.map(lambda peer: shown(peer, scene, samples // 4 if quick else samples), peers))
            found = [None if picture is None else np.asarray(measure(picture)) for picture in drawn]
            print(f"| {name} | " + " | ".join(compared(found, wanted)) + " |", flush=True)


def shown(peer, scene, samples):
    """A peer's picture; None where it has no such material."""
    try:
        peer.build(scene)
    except RuntimeError as error:
        if "NotImplementedError" not in str(error):
            raise
        return None
    return peer.picture(samples)


def compared(found, wanted):
    """What the ratios are to, and those of each peer."""
    middle = np.median([each for each in found if each is not None], axis=0) if wanted is None else np.asarray(wanted)
    return ["median" if wanted is None else "closed form", *("-" if each is None else spread(each / middle) for each in found)]


def spread(ratios):
    """The smallest and the largest, or one where they show alike."""
    low, high = f"{np.min(ratios):.3f}", f"{np.max(ratios):.3f}"
    return low if low == high else f"{low} .. {high}"
