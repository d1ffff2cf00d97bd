#!/usr/bin/env python3
"""How much daylight a floor gets in a year: daylight.py ROOM.ply WEATHER.epw PICTURE.png

Reads the sun and the sky of every hour from an EPW file, makes Perez' sky of each, and lights the
room with all of them. Of the floor it prints and draws daylight autonomy (the part of the hours with
300 lux and more). It prints useful daylight (100 to 3,000 lux), and the hours without glare: those
in which the light at an upright eye stays below DGPs 0.4 (Wienold 2009).

The room is a mesh with +Y up, and north is -Z. Direct light of sky and sun and all bounces count.
"""
import csv
import math
import sys

import numpy as np

import relumine

#: Clearness: bins 1 to 8 begin here. Perez, Seals and Michalsky, "All-weather model for sky luminance distribution", 1993.
BINS = np.array([1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200])
#: Coefficients a1..a4, b1..b4, c1..c4, d1..d4, e1..e4 of each bin, from the same paper.
SHAPES = np.array([
    1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000, 0.6004, 1.2375, 1.0000, 1.8734, 0.6297, 0.9738, 0.2809, 0.0356, -0.1246, -0.5718, 0.9938,
    -1.2219, -0.7730, 1.4148, 1.1016, -0.2054, 0.0367, -3.9128, 0.9156, 6.9750, 0.1774, 6.4477, -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624, 0.0672, -0.2190, -0.4285,
    -1.1000, -0.2515, 0.8952, 0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812, -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199, -0.5562,
    -0.5484, -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297, 33.3389, -18.3000, -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062, 0.4659, -0.3296, -0.0876, -0.0329,
    -0.6000, -0.3566, -2.5000, 2.3250, 0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656, -21.5906, 7.2492, -3.5000, -0.1554, 1.4062, 0.3988, 0.0032, 0.0766, -0.0656, -0.1294,
    -1.0156, -0.3670, 1.0078, 1.4051, 0.2875, -0.5328, -3.8500, 3.3750, 14.0000, -0.9999, -7.1406, 7.5469, -3.4000, -0.1078, -1.0750, 1.5702, -0.0672, 0.4016, 0.3017, -0.4844,
    -1.0000, 0.0211, 0.5025, -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000, 1.2438, -1.9094, -4.0000, 0.0250, 0.3844, 0.2656, 1.0468, -0.3788, -2.4517, 1.4656,
    -1.0500, 0.0289, 0.4260, 0.3590, -0.3250, 0.1156, 0.7781, 0.0025, 31.0625, -14.5000, -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564, 0.5636,
]).reshape(8, 5, 4)  # fmt: skip
#: Lumens per watt of the diffuse and of the direct light: Perez et al., "Modeling daylight availability", 1990.
DIFFUSE = np.array([[97.24, -0.46, 12.00, -8.91], [107.22, 1.15, 0.59, -3.95], [104.97, 2.96, -5.53, -8.77], [102.39, 5.59, -13.95, -13.90],
                    [100.71, 5.94, -22.75, -23.74], [106.42, 3.83, -36.15, -28.83], [141.88, 1.90, -53.24, -14.03], [152.23, 0.35, -45.27, -7.98]])  # fmt: skip
DIRECT = np.array([[57.20, -4.55, -2.98, 117.12], [98.99, -3.46, -1.21, 12.38], [109.83, -4.90, -1.71, -8.81], [110.34, -5.84, -1.99, -4.56],
                   [106.36, -3.97, -1.75, -6.16], [107.19, -1.25, -1.51, -26.73], [105.75, 0.77, -1.26, -34.44], [101.18, 1.58, -1.10, -8.29]])  # fmt: skip
GROUND_ALBEDO = 0.2
#: Hours of the day that count: those that end after FIRST, until LAST.
FIRST, LAST = 8, 18


def read_epw(path):
    """(latitude, longitude, hours east of Greenwich), and rows month, day, hour, direct, diffuse W/m2, dew point C."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    place = rows[0]
    if place[0] != "LOCATION":
        raise SystemExit(f"{path}: expected an EPW file, which begins with LOCATION, got {place[0][:40]}")
    hours = np.array([[float(row[1]), float(row[2]), float(row[3]), float(row[14]), float(row[15]), float(row[7])] for row in rows[8:]])
    return (float(place[6]), float(place[7]), float(place[8])), hours


def sun_of(place, hours):
    """(N, 3) directions to the sun at the middles of the hours, and (N,) the days' distance factors."""
    latitude, longitude, zone = math.radians(place[0]), place[1], place[2]
    before = np.array([0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334])
    day = before[hours[:, 0].astype(int) - 1] + hours[:, 1]
    declination = 0.4093 * np.sin(2 * math.pi * (day - 81) / 368)
    equation = 0.170 * np.sin(4 * math.pi * (day - 80) / 373) - 0.129 * np.sin(2 * math.pi * (day - 8) / 355)
    solar = hours[:, 2] - 0.5 + equation + (longitude - 15 * zone) / 15
    angle = math.pi * (solar - 12) / 12
    up = math.sin(latitude) * np.sin(declination) + math.cos(latitude) * np.cos(declination) * np.cos(angle)
    north = math.cos(latitude) * np.sin(declination) - math.sin(latitude) * np.cos(declination) * np.cos(angle)
    east = -np.cos(declination) * np.sin(angle)
    return np.stack([east, up, -north], axis=1), 1 + 0.033412 * np.cos(2 * math.pi * (day - 3) / 365)


class Sky:
    """Perez' skies of some hours; those without sun and light are left out."""

    def __init__(self, place, hours):
        sun, distance = sun_of(place, hours)
        used = (sun[:, 1] > 0.0) & (hours[:, 4] > 0)
        self.hours, self.sun, distance = hours[used], sun[used], distance[used]
        direct, diffuse, dew = self.hours[:, 3], self.hours[:, 4], self.hours[:, 5]
        zenith = np.arccos(np.minimum(self.sun[:, 1], 1))
        high = 1 / (self.sun[:, 1] + 0.15 * np.maximum(93.885 - np.degrees(zenith), 0.1) ** -1.253)
        brightness = np.clip(diffuse * high / (1367 * distance), 0.01, 0.6)
        clearness = ((diffuse + direct) / diffuse + 1.041 * zenith**3) / (1 + 1.041 * zenith**3)
        kind = np.searchsorted(BINS, clearness, side="right")
        water = np.exp(0.07 * dew - 0.075)
        one = np.ones_like(water)
        self.diffuse = diffuse * (DIFFUSE[kind] * np.stack([one, water, np.cos(zenith), np.log(brightness)], 1)).sum(1)
        self.direct = direct * np.maximum((DIRECT[kind] * np.stack([one, water, np.exp(5.73 * zenith - 5), brightness], 1)).sum(1), 0)
        terms = np.stack([one, zenith, brightness, brightness * zenith], 1)
        self.shape = np.einsum("nij,nj->ni", SHAPES[kind], terms)
        first = kind == 0
        c, d = SHAPES[0][2], SHAPES[0][3]
        lean = brightness * (c[0] + c[1] * zenith)
        self.shape[first, 2] = (np.exp(np.maximum(lean, 0) ** c[2]) - c[3])[first]
        self.shape[first, 3] = (-np.exp(brightness * (d[0] + d[1] * zenith)) + d[2] + brightness * d[3])[first]

    def luminance(self, index, directions, areas):
        """(...) cd/m2 of an hour's sky and ground in directions that stand for areas, sr. Without the sun itself."""
        a, b, c, d, e = self.shape[index]
        up = directions[..., 1]
        cosine = np.clip(directions @ self.sun[index], -1, 1)
        gamma = np.arccos(cosine)
        shape = np.maximum((1 + a * np.exp(b / np.maximum(up, 0.01))) * (1 + c * np.exp(d * gamma) + e * cosine**2), 0)
        shape = np.where(up > 0, shape, 0)
        sky = shape * self.diffuse[index] / (shape * np.maximum(up, 0) * areas).sum()
        ground = GROUND_ALBEDO / math.pi * (self.diffuse[index] + self.direct[index] * self.sun[index, 1])
        return np.where(up > 0, sky, ground)


def cube_directions(resolution):
    """(6, R, R, 3) directions of a cube map's texels, +X -X +Y -Y +Z -Z, and (6, R, R) their areas in sr."""
    # What a lat-long of a coordinate becomes is that coordinate at the texels, without knowing the faces.
    height = 8 * resolution
    theta = (np.arange(height) + 0.5) / height * math.pi
    phi = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2 * math.pi
    sine = np.sin(theta)[:, None]
    grid = np.stack([sine * np.sin(phi), np.cos(theta)[:, None] + 0 * phi, sine * np.cos(phi)], axis=-1)
    mean = relumine.Environment(grid + 2.0, face_resolution=resolution).cube - 2.0
    directions = mean / np.linalg.norm(mean, axis=-1, keepdims=True)
    areas = (2.0 / resolution) ** 2 * np.abs(directions).max(-1) ** 3
    return directions, areas * 4 * math.pi / areas.sum()


def relit(relighter, sky, resolution=32, bounces=True):
    """(hours, receivers) lux of every sky and its sun. One relight an hour."""
    directions, areas = cube_directions(resolution)
    result = np.empty((len(sky.sun), relighter.scene.num_receivers), np.float32)
    cube = np.empty((*directions.shape,), np.float32)
    for index, sun in enumerate(sky.sun):
        cube[...] = sky.luminance(index, directions, areas)[..., None]
        # The sun is a texel that holds all of its light.
        place = np.unravel_index((directions @ sun).argmax(), areas.shape)
        cube[place] += sky.direct[index] / areas[place]
        relighter.set_environment(relumine.Environment(cube, face_resolution=resolution))
        if bounces:
            relighter.bounce()
        result[index] = relighter.radiance[:, 1] * math.pi
    return result


def areas_of(points, triangles):
    """The area that each point stands for."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(triangles.ravel(), np.repeat(area, 3), len(points))


def draw(path, points, triangles, autonomy):
    """The floor from above, north at the top."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots()
    shown = axes.tripcolor(points[:, 0], -points[:, 2], triangles, autonomy, shading="gouraud", vmin=0, vmax=1)
    axes.set_aspect("equal")
    figure.colorbar(shown, label="part of the hours with 300 lux")
    figure.savefig(path, dpi=150)


def main():
    if len(sys.argv) != 4:
        sys.exit("daylight.py ROOM.ply WEATHER.epw PICTURE.png")
    mesh, weather, picture = sys.argv[1:]
    place, hours = read_epw(weather)
    hours = hours[(hours[:, 2] > FIRST) & (hours[:, 2] <= LAST)]
    sky = Sky(place, hours)
    room = relumine.Mesh.load(mesh)
    if room.materials:
        sys.exit(f"{mesh}: expected a mesh without materials, such as a .ply, got {len(room.materials)}")
    scene = relumine.precompute(room, bounces=True)
    lux = relit(relumine.Relighter(scene), sky)
    floor = scene.triangles[(scene.normals[scene.triangles, 1] > 0.99).all(axis=1)]
    if not len(floor):
        sys.exit(f"{mesh}: expected a floor that looks up (+Y), got none")
    area = areas_of(scene.positions, floor)
    autonomy = (lux >= 300).sum(0) / len(hours)
    useful = ((lux >= 100) & (lux <= 3000)).sum(0) / len(hours)
    print(f"{len(hours)} hours, {len(hours) - len(sky.sun)} of them dark; a floor of {area.sum():.1f} square units")
    print(f"daylight autonomy at 300 lux: {np.average(autonomy, weights=area):.3f}")
    print(f"useful daylight, 100 to 3000 lux: {np.average(useful, weights=area):.3f}")
    # DGPs = 6.22e-5 Ev + 0.184, of the light on an upright eye; walls stand in for eyes.
    upright = np.abs(scene.normals[:, 1]) < 0.1
    if upright.any():
        glare = (6.22e-5 * lux[:, upright] + 0.184 > 0.4).sum(0)
        print(f"hours without glare at the walls: {len(hours) - glare.mean():.0f}")
    draw(picture, scene.positions, floor, autonomy)


if __name__ == "__main__":
    main()
