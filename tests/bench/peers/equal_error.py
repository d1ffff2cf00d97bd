"""Time to equal error: what each peer takes until its picture is as near to the truth as Relumine's.

A path tracer's square error at n samples is half of that between two pictures with other random
numbers. It is measured at two n, and taken to fall as a power of n. Time is a part that does not
depend on n, and one that grows with n. Relumine's square error is the product of what its picture
differs by from two of the judge: noise that these do not share falls out. All errors are relative
L2 over the pixels that show the scene alone. Times are processor seconds.
"""
import io
import json
import os
import struct
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import scenes

ROOT = Path(__file__).resolve().parents[3]
DATA = Path(os.environ.get("RELUMINE_DATA", ""))
#: Pixels of a side of the picture, with and without --quick.
SIZE = {True: 128, False: 256}
#: Rows of the maps.
HEIGHT = 256
#: No error below it is asked for.
FINE = 0.01
#: Samples a pixel that are measured: few and many; those of the judge of Relumine's error.
COUNTS, JUDGE_COUNTS = (8, 32), (16, 256)


def generated(name, folder):
    program = os.environ.get("RELUMINE_PROGRAM") or ROOT / "build" / "release" / "app" / "relumine"
    subprocess.run([str(program), "generate", name, "-o", folder, "--vertices", "20000", "-q"], check=True)
    return Path(folder) / f"{name}.ply"


def matte(own, path, floor, albedo):
    """One shape of a mesh's file, without vertices that no triangle has: they have no normal."""
    vertices, triangles, normals = own.mesh(str(path), floor)
    used, triangles = np.unique(triangles, return_inverse=True)
    return [scenes.shape(vertices[used], triangles.reshape(-1, 3), scenes.material(color=(albedo,) * 3), normals[used])]


def bunny(own, _):
    shapes = matte(own, DATA / "meshes/stanford/bun_zipper.ply", 193, 0.5)
    return shapes, [((0.05, 0.22, 0.35), (-0.02, 0.09, 0), 40), ((-0.3, 0.2, 0.2), (-0.02, 0.09, 0), 40)], (), 0


def colonnade(own, folder):
    return matte(own, generated("colonnade", folder), None, 0.5), [((9, 6, 13), (0, 1.5, 0), 45), ((-12, 5, 9), (0, 1.5, 0), 45)], (), 0


def room(own, folder):
    """A room with one window, and a lamp below its ceiling: all bounces."""
    lamps = [{"position": (0.5, 2.2, 0.5), "intensity": (1.0, 0.9, 0.8)}]
    return matte(own, generated("room", folder), None, 0.6), [((1.7, 1.6, 2.2), (-0.5, 0.9, -0.8), 65), ((1.6, 2.2, -2.0), (-0.5, 0.7, 0.8), 65)], lamps, None


def helmet(own, _):
    """An asset of materials, as all peers take them alike: metals of one roughness and matte surfaces, each of two colours."""
    from PIL import Image

    path = DATA / "khronos/models/DamagedHelmet/glTF-Binary/DamagedHelmet.glb"
    file = path.read_bytes()
    length = struct.unpack("<I", file[12:16])[0]
    document, binary = json.loads(file[20 : 20 + length]), file[28 + length :]
    vertices, triangles, normals = own.mesh(str(path), None)
    column, row = np.floor(own.uvs(str(path))[triangles].mean(1).T * 256).astype(int) % 256

    def texture(number):
        view = document["bufferViews"][document["images"][number]["bufferView"]]
        picture = Image.open(io.BytesIO(binary[view["byteOffset"] :][: view["byteLength"]])).convert("RGB")
        return np.asarray(picture.resize((256, 256), Image.BOX), float)[row, column] / 255

    # An approximate sRGB curve; the means of colours are what matters.
    colors, is_metal = texture(0) ** 2.2, texture(1)[:, 2] > 0.5
    bright = colors.mean(1)
    shapes = []
    for kind, of_kind in (("metal", is_metal), ("matte", ~is_metal)):
        middle = np.median(bright[of_kind])
        for chosen in (of_kind & (bright <= middle), of_kind & (bright > middle)):
            used, corners = np.unique(triangles[chosen], return_inverse=True)
            surface = scenes.material(kind, colors[chosen].mean(0).tolist(), roughness=0.3)
            shapes.append(scenes.shape(vertices[used], corners.reshape(-1, 3), surface, normals[used]))
    # All bounces: a metal that shows another one is not black.
    return shapes, [((0, 0, 3), (0, 0, 0), 45), ((1.8, 0.6, 2.3), (0, 0, 0), 45)], (), None


SCENES = {"bunny": bunny, "colonnade": colonnade, "room": room, "helmet": helmet}
#: Scenes that Relumine has no matrix of bounces for: its metals mirror each other without one, and what is matte is dark.
MIRRORED = ("helmet",)
#: Who says what a picture should be, where it is not Mitsuba: its metals lose light.
JUDGES = {"helmet": ("Cycles", "Mitsuba")}
#: Peers that keep a picture for each lamp and one for the rest: groups().
GROUPED = ("Cycles", "LuxCore")


class Measured:
    """What two numbers of samples say of a peer: pictures, seconds and errors."""

    def __init__(self, peer, counts, mask, is_first, picture=None):
        """`picture` takes a number of samples; the peer's own where none is given."""
        seconds, squares = [], []
        for count in counts:
            pair, spent = [], []
            for _ in range(2):
                pair.append(np.asarray((picture or peer.picture)(count), float)[mask])
                spent.append(peer.processor)
            # Only a first picture compiles kernels and builds trees.
            seconds.append(spent[0] if is_first and not seconds else min(spent))
            squares.append(((pair[0] - pair[1]) ** 2).mean() / 2)
        self.pictures, self.square, self.most = pair, squares[1], counts[1]
        self.power = np.log(squares[0] / squares[1]) / np.log(counts[1] / counts[0])
        self.slope = max(seconds[1] - seconds[0], 0) / (counts[1] - counts[0])
        self.constant = max(seconds[0] - self.slope * counts[0], 0)

    def seconds_to(self, square):
        """Those of a picture of this square error, one sample a pixel at least; None where samples do not help."""
        if self.power < 0.2:
            return None
        return self.constant + self.slope * max(1, self.most * (self.square / square) ** (1 / self.power))


    def told(self, judges):
        """How far its expected picture is from the judge's, its noise, and the power by which that falls."""
        noise = np.sqrt(self.square / product(*judges))
        return f"{apart(self.pictures, judges):.3f}, {noise:.3f} at {self.most}, {self.power / 2:.2f}"


def product(first, second):
    return float((first * second).mean())


def apart(pictures, judges):
    """The relative L2 between what two pairs of pictures are without noise; negative: less than can be told."""
    square = product(pictures[0] - judges[0], pictures[1] - judges[1]) / product(*judges)
    return float(np.sign(square) * np.sqrt(abs(square)))


#: The event that light groups need no rays for.
LAMP = "lamp in another colour"


def lights(own):
    """Maps: a sunset, a studio, and a sky without a sun."""
    return [own.lat_long(str(DATA / "envs/latlong" / name), HEIGHT) for name in ("sunset_1k.hdr", "studio_1k.hdr", "venice_1k.hdr")]


def events(domes, lamps):
    """Rows: name, light before, light of the picture; None: the eye moves."""
    first, second, sky = domes
    suns = [[{"direction": direction, "irradiance": (6.0, 5.5, 5.0)}] for direction in ((0.5, 0.6, 0.6), (0.35, 0.6, 0.8))]
    disc = {"direction": (0.5, 0.6, 0.6), "degrees": np.degrees(np.arccos(0.9)), "factor": 3.0}
    plain = scenes.light(second, lamps=lamps)
    rows = [
        ("next map", scenes.light(first, lamps=lamps), plain),
        ("edit of 5 % of the map", plain, scenes.light(second, lamps=lamps, regions=[disc])),
        ("moved sun", scenes.light(sky, suns=suns[0], lamps=lamps), scenes.light(sky, suns=suns[1], lamps=lamps)),
    ]
    if lamps:
        colored = [{**each, "intensity": (np.asarray(each["intensity"]) * (0.4, 0.8, 1.6)).tolist()} for each in lamps]
        rows.append((LAMP, rows[-1][2], scenes.light(sky, suns=suns[1], lamps=colored)))
    return [*rows, ("moved eye", None, None)]


def played(peer, scene, rows, eye):
    """Builds the scene, then does row after row: yields each with its seconds, before the picture."""
    peer.build(scene)
    yield "first light", peer.processor
    now = scene["light"]
    for name, before, after in rows:
        if after is None:
            peer.look(eye)
        else:
            if before is not now:
                peer.relight(before)
                peer.picture(1)
            peer.relight(after)
            now = after
        yield name, peer.processor


def by_groups(peer, row, mask):
    """(seconds of a mix, what its pictures are and the rendering before it takes) of LAMP's row."""
    _, before, after = row
    factors = [np.ones(3), *(np.divide(new["intensity"], old["intensity"]) for new, old in zip(after["lamps"], before["lamps"]))]
    mixes = []

    def picture(count):
        peer.groups(count)
        rendered = peer.processor
        mixed = peer.mixed(factors)
        mixes.append(peer.processor)
        peer.processor = rendered
        return mixed

    peer.relight(before)
    measured = Measured(peer, COUNTS, mask, False, picture)
    peer.relight(after)
    return min(mixes), measured


def run(peers, quick, wanted):
    """Of the wanted SCENES. Prints a table of what each event takes, and one of how far the peers' pictures are from the judge's."""
    found = {peer.name: peer for peer in peers}
    own = found.pop("Relumine", None)
    if own is None or not found:
        return
    if not DATA.parts:
        print("\nTime to equal error: expected RELUMINE_DATA, the folder of docs/data.md, got none", flush=True)
        return
    names = list(found)
    print(
        "\n### Time to equal error\n\n| scene | event | Relumine's pixels: error, seconds | its vertices: error, seconds | error asked for | "
        + " | ".join(names) + " | fastest / Relumine |\n" + "|---" * (len(names) + 6) + "|", flush=True,
    )  # fmt: skip
    distances = []
    for name in wanted:
        make = SCENES[name]
        judge = next((each for each in JUDGES.get(name, ("Mitsuba",)) if each in found), names[0])
        with tempfile.TemporaryDirectory() as folder:
            shapes, cameras, lamps, bounces = make(own, folder)
        cameras = [scenes.camera(*each, SIZE[quick]) for each in cameras]
        domes = lights(own)
        scene = scenes.scene(shapes, cameras[0], scenes.light(domes[0], lamps=lamps), bounces)
        scene["roulette"] = True  # paths end by chance, as in each peer's defaults
        rows = events(domes, lamps)
        ours = {}
        for pixels in (True, False):
            options = {"background": "none", "pixels": pixels, **({"bounces": 0} if name in MIRRORED else {})}
            for event, spent in played(own, {**scene, **options}, rows[:-1] if pixels else rows, cameras[1]):
                drawn = own.masked(16)
                ours[event, pixels] = spent + own.processor, *drawn
        theirs, grouped = {}, {}
        # What every kind of picture shows wholly.
        mask = {event: np.logical_and.reduce([ours[event, pixels][2] for pixels in (True, False) if (event, pixels) in ours]) for event, _ in ours}
        for each, peer in found.items():
            for event, spent in played(peer, scene, rows, cameras[1]):
                if event == LAMP and each in GROUPED:
                    grouped[each] = by_groups(peer, rows[-2], mask[event])
                theirs[event, each] = spent, Measured(peer, JUDGE_COUNTS if each == judge else COUNTS, mask[event], event == "first light")
        for event in mask:
            judges = theirs[event, judge][1].pictures
            cells, told, away = [], {}, []
            for pixels in (True, False):
                if (event, pixels) not in ours:
                    cells.append("-")
                    continue
                spent, picture, _ = ours[event, pixels]
                told[pixels] = apart([picture[mask[event]]] * 2, judges), spent
                cells.append(f"{told[pixels][0]:.3f}, {spent:.3g}")
            error, spent = next(iter(told.values()))
            asked = max(abs(error), FINE)  # negative: less than can be told
            brightness = product(*judges)
            seconds = {}
            for each in names:
                before, rendered = theirs[event, each]
                rest = rendered.seconds_to(asked**2 * brightness)
                seconds[each] = None if rest is None else before + rest
                away.append(rendered.told(judges))
            fastest = min((each for each in seconds.values() if each is not None), default=np.nan)
            shown = " | ".join("-" if seconds[each] is None else f"{seconds[each]:.3g}" for each in names)
            print(f"| {name} | {event} | {cells[0]} | {cells[1]} | {asked:.3f} | {shown} | {fastest / spent:.3g} |", flush=True)
            distances.append(f"| {name} | {event} | " + " | ".join(away) + " |")
            if event == LAMP and grouped:
                cells += [f"{asked:.3f}"]
                for each in names:
                    mix, rendered = grouped.get(each, (None, None))
                    before = rendered and rendered.seconds_to(asked**2 * brightness)
                    cells.append(f"{mix:.3g} after {before:.3g}" if before else "-")
                fastest = min(mix for mix, _ in grouped.values())
                print(f"| {name} | the same, by light groups | " + " | ".join(cells) + f" | {fastest / spent:.3g} |", flush=True)
                away = [grouped[each][1].told(judges) if each in grouped else "-" for each in names]
                distances.append(f"| {name} | the same, by light groups | " + " | ".join(away) + " |")
    print(
        "\nHow far each expected picture is from the judge's, the noise at so many samples, and the power of the samples by which it falls:\n\n"
        "| scene | event | " + " | ".join(names) + " |\n" + "|---" * (len(names) + 2) + "|\n" + "\n".join(distances), flush=True,
    )  # fmt: skip
