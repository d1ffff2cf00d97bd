"""Relumine, through its Python package; the scene goes in as a glTF file, as from any modeller."""
import base64
import json
import os
import sys
import tempfile
import warnings

import numpy as np
import relumine
from relumine import _core

NAME = "Relumine"
#: Suns over a dome are layers this wide.
SUN_DEGREES = 0.1
sys.path.append(os.path.join(os.path.dirname(__file__), "../../../examples/python"))
warnings.simplefilter("ignore", relumine.RelumineWarning)


def version():
    return relumine.__version__


def _material(given):
    kind, color = given["kind"], list(given["color"])
    pbr = {"baseColorFactor": color + [1.0], "metallicFactor": 1.0 if kind == "metal" else 0.0, "roughnessFactor": given["roughness"]}
    result = {"pbrMetallicRoughness": pbr, "extensions": {}, "doubleSided": True}
    extensions = result["extensions"]
    if kind == "matte":  # no highlight at all
        pbr["roughnessFactor"] = 1.0
        extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
    if kind == "glass":
        pbr["roughnessFactor"] = 0.0
        extensions["KHR_materials_transmission"] = {"transmissionFactor": 1.0}
        extensions["KHR_materials_volume"] = {"thicknessFactor": 1.0}
        extensions["KHR_materials_ior"] = {"ior": given["ior"]}
        result["doubleSided"] = False
    if given["coat"]:
        extensions["KHR_materials_clearcoat"] = {"clearcoatFactor": given["coat"], "clearcoatRoughnessFactor": 0.0}
    if any(given["sheen"]):
        extensions["KHR_materials_sheen"] = {"sheenColorFactor": list(given["sheen"]), "sheenRoughnessFactor": given["sheen_roughness"]}
    if any(given["glow"]):
        strength = max(given["glow"])
        result["emissiveFactor"] = [each / strength for each in given["glow"]]
        extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    return result


def write_gltf(path, shapes, lamps=()):
    """Writes shapes and point lights as one .gltf file."""
    binary, views, accessors, meshes, nodes, materials = bytearray(), [], [], [], [], []

    def accessor(array, kind, target):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes, "target": target})
        binary.extend(array.tobytes())
        accessors.append({
            "bufferView": len(views) - 1, "count": array.size if kind == "SCALAR" else len(array), "type": kind,
            "componentType": 5125 if array.dtype == np.uint32 else 5126,
            **({} if kind == "SCALAR" else {"min": array.min(0).tolist(), "max": array.max(0).tolist()}),
        })  # fmt: skip
        return len(accessors) - 1

    for number, each in enumerate(shapes):
        attributes = {"POSITION": accessor(each["vertices"].astype(np.float32), "VEC3", 34962)}
        if each["normals"] is not None:
            attributes["NORMAL"] = accessor(each["normals"].astype(np.float32), "VEC3", 34962)
        corners = accessor(each["triangles"].astype(np.uint32).ravel(), "SCALAR", 34963)
        meshes.append({"primitives": [{"attributes": attributes, "indices": corners, "material": number}]})
        materials.append(_material(each["material"]))
        nodes.append({"mesh": number, "name": f"shape{number}"})
    lights = []
    for lamp in lamps:
        strength = max(lamp["intensity"])
        lights.append({"type": "point", "color": [each / strength for each in lamp["intensity"]], "intensity": strength})
        nodes.append({"translation": list(lamp["position"]), "name": f"lamp{len(lights)}",
                      "extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}})  # fmt: skip
    used = {name for each in materials for name in each["extensions"]} | ({"KHR_lights_punctual"} if lights else set())
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(binary), "uri": "data:application/octet-stream;base64," + base64.b64encode(binary).decode()}],
        **({"extensionsUsed": sorted(used)} if used else {}),
        **({"extensions": {"KHR_lights_punctual": {"lights": lights}}} if lights else {}),
    }  # fmt: skip
    with open(path, "w") as file:
        json.dump(document, file)


class State:
    pass


def build(scene):
    state = State()
    state.bounces = scene["bounces"]
    state.camera = scene["camera"]
    state.lamps = scene["light"]["lamps"]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.gltf")
        write_gltf(path, scene["shapes"], scene["light"]["lamps"])
        mesh = relumine.Mesh.load(path)
        view = state.camera
        pixels = {"receivers": f"pixels:{view['size']}x{view['size']}", "view": (view["eye"], view["target"], view["fov"])} if scene.get("pixels") else {}
        if scene.get("gradient"):
            pixels["receivers"] += ":16"
            pixels["material"] = relumine.Lambert()
        state.scene = relumine.precompute(mesh, bounces=state.bounces != 0, **pixels)
    state.relighter = relumine.Relighter(state.scene, **({"highlight_rays": 0} if scene.get("gradient") else {}))
    state.pixels = bool(pixels)
    state.faces = 64 if scene.get("gradient") else 0
    state.background = scene.get("background", "sharp")
    state.light = None
    relight(state, scene["light"])
    return state


def relight(state, light):
    """Only what differs from the light before is changed: the dome, layers over it, factors of lamps."""
    state.emission = [
        f"lamp{number}=1," + ",".join(str(new / old) for new, old in zip(lamp["intensity"], built["intensity"]))
        for number, (lamp, built) in enumerate(zip(light["lamps"], state.lamps), 1)
    ]
    before, state.light = state.light, light
    suns = light["suns"]
    if light["dome"] is None and suns:
        state.relighter.set_lights(relumine.LightList([sun["direction"] for sun in suns], [sun["irradiance"] for sun in suns]))
        is_other = True
    else:
        is_other = before is None or not all(np.array_equal(before[name], light[name]) for name in ("dome", "turn"))
        if is_other:
            dome = np.zeros((16, 32, 3), np.float32) if light["dome"] is None else light["dome"]
            environment = relumine.Environment(dome, face_resolution=state.faces)
            state.relighter.set_environment(environment.turned(turn=light["turn"]))
        layers = _layers(light)
        if layers != (_layers(before) if before else []):
            state.relighter.set_layers(layers)
            is_other = True
    if is_other and state.bounces != 0:
        state.relighter.bounce(state.bounces)


def _layers(light):
    """Regions and suns over a dome."""
    if light["dome"] is None:
        return []
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEGREES / 2)))
    regions = [relumine.Layer(f"region{number}", relumine.Disc(each["direction"], each["degrees"]), relumine.Gain(each["factor"])) for number, each in enumerate(light["regions"])]
    suns = [
        relumine.Layer(f"sun{number}", relumine.Disc(each["direction"], SUN_DEGREES / 2), relumine.Emit([value / solid_angle for value in each["irradiance"]]))
        for number, each in enumerate(light["suns"])
    ]  # fmt: skip
    return regions + suns


def look(state, camera):
    state.camera = camera


def picture(state, samples):
    """`samples` are those of highlights; what is matte has no noise."""
    return _drawn(state, samples)[..., :3]


def masked(state, samples):
    """The same, and where the scene alone is seen."""
    drawn = _drawn(state, samples)
    return drawn[..., :3], drawn[..., 3] == 1


def _drawn(state, samples):
    view = state.camera
    seen = {} if state.pixels else {"size": (view["size"], view["size"]), "eye": view["eye"], "target": view["target"], "fov": view["fov"], "highlight_rays": samples}
    return np.asarray(state.relighter.picture(albedo=1.0, background=state.background, **seen, **({"emission": state.emission} if state.emission else {})))


def gradient(state, weights, height):
    """The derivative of sum(weights * picture) by the pixels of the dome, (height, 2 height, 3); of a scene of pixels."""
    cube = state.relighter.picture_adjoint(weights, albedo=1.0, background="none")
    return np.asarray(_core.lat_long_adjoint(cube, cube.shape[1], 2 * height, height))


def lat_long(_, path, height):
    """The pixels of an environment's file, as means of height x 2 height blocks."""
    pixels = np.asarray(relumine.Environment.load(path).pixels)[..., :3]
    block = len(pixels) // height
    return pixels.reshape(height, block, 2 * height, block, 3).mean((1, 3))


def mesh(_, path, floor):
    """(vertices, triangles, normals) of a mesh's file."""
    found = relumine.Mesh.load(path, floor=floor)
    return tuple(np.asarray(each) for each in (found.vertices, found.triangles, found.normals))


def uvs(_, path):
    """(N, 2) of a mesh's file, as its format has them."""
    return np.asarray(relumine.Mesh.load(path).uvs)


def year(state, skies, division, sensors):
    """(hours, sensors) irradiance in W/m2, one relight an hour."""
    import daylight
    import skies as judge

    resolution, parts = 32 if division == 1 else 64, 4
    directions, _ = daylight.cube_directions(parts * resolution)
    patches = judge.patch_of(directions @ judge.NORTH_IS_Y.T, division).reshape(6, resolution, parts, resolution, parts)
    result = np.empty((skies.shape[1], len(sensors)), np.float32)
    cube = np.empty((6, resolution, resolution, 3), np.float32)
    for hour in range(skies.shape[1]):
        cube[...] = np.ascontiguousarray(skies[:, hour])[patches].mean((2, 4))[..., None]
        state.relighter.set_environment(relumine.Environment(cube, face_resolution=resolution))
        state.relighter.bounce()
        result[hour] = np.asarray(state.relighter.radiance)[sensors, 1]
    return result * np.pi / judge.FLOOR_ALBEDO
