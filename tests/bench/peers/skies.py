"""Many skies: the daylight of a year on the floor of a room with a window, Radiance's matrices beside Relumine.

Radiance's sky of an hour is a brightness for each patch of Reinhart's division. Both get these."""
import numpy as np

import scenes

#: Vertices on each side of the floor; those inside are sensors.
SIDE = 47
FLOOR_ALBEDO = 0.3
#: Relumine's north is -Z and Radiance's +Y: times a vector of the one this is that of the other.
NORTH_IS_Y = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


def room():
    """6 x 8 x 3 metres, its window to the south (+Z), and the vertices of its floor, the first shape, that are sensors."""
    floor, wall, ceiling = (scenes.material("matte", (albedo,) * 3) for albedo in (FLOOR_ALBEDO, 0.6, 0.8))
    width, height, depth = 6.0, 3.0, 8.0
    left, right, sill, head = 1.0, 5.0, 0.9, 2.5

    def facing(corner, side, other, surface, steps):
        made = scenes.quad(corner, side, other, surface, steps)
        normal = np.cross(side, other)
        made["normals"] = np.broadcast_to(normal / np.linalg.norm(normal), made["vertices"].shape)
        return made

    shapes = [
        facing((0, 0, 0), (0, 0, depth), (width, 0, 0), floor, SIDE - 1),
        facing((0, height, 0), (width, 0, 0), (0, 0, depth), ceiling, 24),
        facing((0, 0, 0), (width, 0, 0), (0, height, 0), wall, 24),
        facing((0, 0, 0), (0, height, 0), (0, 0, depth), wall, 24),
        facing((width, 0, 0), (0, 0, depth), (0, height, 0), wall, 24),
    ]
    for low_x, high_x, low_y, high_y in ((0, left, 0, height), (right, width, 0, height), (left, right, 0, sill), (left, right, head, height)):
        shapes.append(facing((low_x, low_y, depth), (0, high_y - low_y, 0), (high_x - low_x, 0, 0), wall, 12))
    return {"shapes": shapes, "camera": None, "light": scenes.light(), "bounces": None}, np.arange(SIDE**2).reshape(SIDE, SIDE)[1:-1, 1:-1].ravel()


def weather():
    """A year of made weather at 45 degrees north, as a .wea file: each day has its share of clouds."""
    rows = ["place made", "latitude 45", "longitude 0", "time_zone 0", "site_elevation 0", "weather_data_file_units 1"]
    random = np.random.default_rng(1)
    day = 0
    for month, days in enumerate((31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31), 1):
        for date in range(1, days + 1):
            day += 1
            clouds = random.uniform(0, 1)
            declination = 0.409 * np.sin(2 * np.pi * (day - 81) / 368)
            for hour in range(24):
                angle = np.pi * (hour + 0.5 - 12) / 12
                up = np.sin(np.pi / 4) * (np.sin(declination) + np.cos(declination) * np.cos(angle))
                if up <= 0.01:
                    continue
                direct = 900 * (1 - clouds) ** 1.5 * up**0.2
                diffuse = (80 + 300 * clouds * (1.2 - clouds)) * up**0.6
                rows.append(f"{month} {date} {hour + 0.5:.3f} {direct:.0f} {diffuse:.0f}")
    return "\n".join(rows) + "\n"


def patch_of(directions, division):
    """The patch of Reinhart's division that Radiance's vectors (..., 3) lie in: 0 is the ground, then from the horizon up."""
    rows = [each for each in (30, 30, 24, 24, 18, 12, 6) for _ in range(division)]
    counts = np.array([division * each for each in rows] + [1])
    first = 1 + np.concatenate([[0], np.cumsum(counts)])
    height = 90 / (7 * division + 0.5)
    row = np.minimum(np.degrees(np.arcsin(np.clip(directions[..., 2], -1, 1))) / height, 7 * division).astype(int)
    azimuth = np.arctan2(directions[..., 0], directions[..., 1]) / (2 * np.pi)
    column = np.floor(azimuth * counts[row] + 0.5).astype(int) % counts[row]
    return np.where(directions[..., 2] < 0, 0, first[row] + column)


def run(peers, quick):
    """Prints how far the illuminance of both is from Radiance's with many rays, and what it took."""
    found = {peer.name: peer for peer in peers if peer.name in ("Relumine", "Radiance")}
    if len(found) < 2:
        return
    own, peer = found["Relumine"], found["Radiance"]
    scene, chosen = room()
    given = weather()
    turned = {**scene, "shapes": [{**each, "vertices": each["vertices"] @ NORTH_IS_Y.T, "normals": each["normals"] @ NORTH_IS_Y.T} for each in scene["shapes"]]}
    sensors = turned["shapes"][0]["vertices"][chosen] + (0, 0, 1e-3)
    print("\n### Many skies\n\n| of | sky | hours | processor seconds: once, then a year | peak MB | off Radiance's with many rays: L2 | median of all | mean over mean |\n" + "|---" * 8 + "|")
    peer.build(turned)
    # A few sensors with many rays are the judge.
    few = np.random.default_rng(2).choice(len(chosen), 20 if quick else 60, replace=False)
    for division in (1,) if quick else (1, 4):
        skies = peer.skies(given, division)
        peer.coefficients(sensors[few], division, 16384 if quick else 65536)
        wanted = np.array(peer.year(skies))
        rows = []
        peer.coefficients(sensors, division, 1024 if quick else 4096)
        once = peer.processor
        rows.append(("Radiance", once, np.array(peer.year(skies)), peer.processor, peer.peak))
        own.build(scene)
        once = own.processor
        rows.append(("Relumine, a relight an hour", once, np.array(own.year(skies, division, chosen)), own.processor, own.peak))
        # As Radiance does: what each patch gives, then a product.
        given_by = np.array(own.year(np.eye(len(skies), dtype=np.float32), division, chosen))
        rows.append(("Relumine, a relight a patch", once + own.processor, skies.T @ given_by, 0.0, own.peak))
        for name, once, light, seconds, peak in rows:
            off = np.linalg.norm(light[:, few] - wanted) / np.linalg.norm(wanted)
            median = np.median(np.abs(light[:, few] / wanted - 1))
            share = light[:, few].mean() / wanted.mean()
            print(f"| {name} | {skies.shape[0] - 1} patches | {skies.shape[1]} | {once:.1f}, {seconds:.1f} | {peak / 1e6:.0f} | {off:.4f} | {median:.4f} | {share:.4f} |", flush=True)
