"""LuxCore, through the package pyluxcore: path tracing on the processor."""
import time

import numpy as np
import pyluxcore

from scenes import axes_of, dome_of

NAME = "LuxCore"
pyluxcore.Init(lambda message: None)
#: LuxCore shows a lat-long mirrored, its middle at -X and +Z up. What takes a mirrored one of ours back to our world.
DOME = np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]])


def version():
    return pyluxcore.Version()


def _properties(rows):
    made = pyluxcore.Properties()
    for name, value in rows.items():
        values = list(value) if isinstance(value, (tuple, list, np.ndarray)) else [value]
        made.Set(pyluxcore.Property(name, [each.item() if isinstance(each, np.generic) else each for each in values]))
    return made


def _material(given, name):
    kind, color = given["kind"], list(given["color"])
    row = f"scene.materials.{name}."
    if kind == "glass":
        result = {"type": "glass", "kr": [1.0] * 3, "kt": [1.0] * 3, "interiorior": given["ior"], "exteriorior": 1.0}
    elif kind == "matte" and not given["coat"] and not any(given["sheen"]):
        result = {"type": "matte", "kd": color}
    else:
        result = {
            "type": "disney", "basecolor": color, "metallic": 1.0 if kind == "metal" else 0.0, "roughness": given["roughness"],
            "specular": 0.0 if kind == "matte" else 0.5, "clearcoat": given["coat"], "clearcoatgloss": 1.0, "sheen": max(given["sheen"]),
        }  # fmt: skip
    if any(given["glow"]):
        result["emission"] = list(given["glow"])
    return {row + key: value for key, value in result.items()}


class State:
    pass


def build(scene):
    state = State()
    state.scene = pyluxcore.Scene()
    state.bounces = scene["bounces"]
    state.has_roulette = bool(scene.get("roulette"))
    state.has_glass = any(each["material"]["kind"] == "glass" for each in scene["shapes"])
    for number, each in enumerate(scene["shapes"]):
        normals = None if each["normals"] is None else [tuple(row) for row in each["normals"].tolist()]
        state.scene.DefineMesh(
            f"mesh{number}", [tuple(row) for row in each["vertices"].tolist()], [tuple(row) for row in each["triangles"].tolist()],
            normals, None, None, None,
        )  # fmt: skip
        rows = _material(each["material"], f"material{number}")
        rows[f"scene.objects.shape{number}.shape"] = f"mesh{number}"
        rows[f"scene.objects.shape{number}.material"] = f"material{number}"
        state.scene.Parse(_properties(rows))
    state.seed = state.domes = 0
    state.lights = []
    look(state, scene["camera"])
    relight(state, scene["light"])
    return state


def relight(state, light):
    for name in state.lights:
        state.scene.DeleteLight(name)
    rows = {}
    if light["dome"] is not None:
        dome = dome_of(light)
        height, width, _ = dome.shape
        state.domes += 1
        name = f"dome{state.domes}"
        state.scene.DefineImageMap(name, np.ascontiguousarray(dome[:, ::-1]).ravel(), 1.0, 3, width, height)
        turn = np.eye(4)
        turn[:3, :3] = light["turn"] @ DOME
        rows |= {"scene.lights.dome.type": "infinite", "scene.lights.dome.file": name, "scene.lights.dome.gamma": 1.0,
                 "scene.lights.dome.transformation": turn.T.ravel()}  # fmt: skip
    for number, sun in enumerate(light["suns"]):
        row = f"scene.lights.sun{number}."
        rows |= {row + "type": "sharpdistant", row + "direction": [-float(each) for each in sun["direction"]], row + "color": list(sun["irradiance"])}
    for number, lamp in enumerate(light["lamps"]):
        row = f"scene.lights.lamp{number}."
        rows |= {row + "type": "point", row + "position": list(map(float, lamp["position"])), row + "color": [4 * np.pi * each for each in lamp["intensity"]], row + "id": number + 1}
    state.lights = sorted({name.split(".")[2] for name in rows})
    if not rows:  # a scene without any light is refused
        rows = {"scene.lights.none.type": "constantinfinite", "scene.lights.none.color": [0.0] * 3}
        state.lights = ["none"]
    state.scene.Parse(_properties(rows))


def look(state, camera):
    _, up, _ = axes_of(camera)
    state.size = camera["size"]
    state.scene.Parse(_properties({
        "scene.camera.type": "perspective", "scene.camera.lookat.orig": list(camera["eye"]), "scene.camera.lookat.target": list(camera["target"]),
        # Pictures lie one row lower than the camera says.
        "scene.camera.screenwindow": [-1.0, 1.0, -1.0 - 2 / state.size, 1.0 - 2 / state.size],
        "scene.camera.up": up, "scene.camera.fieldofview": camera["fov"], "scene.camera.lensradius": 0.0, "scene.camera.autofocus.enable": False,
    }))  # fmt: skip


def picture(state, samples):
    return _rendered(state, samples, {}, [(pyluxcore.FilmOutputType.RGB, 0)])[0]


def groups(state, samples):
    """Renders a picture of each lamp and one of all other lights, for mixed()."""
    count = 1 + sum(name.startswith("lamp") for name in state.lights)
    outputs = {}
    for number in range(count):
        row = f"film.outputs.{number + 1}."
        outputs |= {row + "type": "RADIANCE_GROUP", row + "id": number, row + "filename": f"unused{number}.exr"}
    state.groups = _rendered(state, samples, outputs, [(pyluxcore.FilmOutputType.RADIANCE_GROUP, number) for number in range(count)])


def mixed(state, factors):
    """The picture with the groups times factors: that of the other lights, then those of the lamps."""
    return sum(picture * np.asarray(factor, np.float32) for picture, factor in zip(state.groups, factors))


def _rendered(state, samples, outputs, wanted):
    """The wanted (output, number) of a film."""
    state.seed += 1
    # Paths of one vertex sample lights alone, and highlights are noise; those of two show the same light.
    depth = 64 if state.bounces is None or state.has_glass else state.bounces + 2
    depths = {f"path.pathdepth.{name}": depth for name in ("total", "diffuse", "glossy", "specular")}
    config = pyluxcore.RenderConfig(_properties({
        "renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "film.width": state.size, "film.height": state.size,
        "film.filter.type": "NONE", "batch.haltspp": samples, "renderengine.seed": state.seed, **depths, "path.russianroulette.depth": 3 if state.has_roulette else 64,
        "film.imagepipelines.0.0.type": "NOP", "film.outputs.0.type": "RGB", "film.outputs.0.filename": "unused.exr",
        **outputs,
    }), state.scene)  # fmt: skip
    session = pyluxcore.RenderSession(config)
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    pictures = []
    for output, number in wanted:
        pixels = np.zeros(state.size * state.size * 3, np.float32)
        session.GetFilm().GetOutputFloat(output, pixels, number)
        pictures.append(pixels.reshape(state.size, state.size, 3)[::-1].copy())
    session.Stop()
    return pictures
