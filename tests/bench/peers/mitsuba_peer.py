"""Mitsuba 3: path tracing, compiled for the processor by LLVM where that is found."""
import drjit as dr
import mitsuba as mi
import numpy as np

from scenes import axes_of, dome_of

NAME = "Mitsuba"


def _variant():
    """llvm_ad_rgb where LLVM runs, else scalar_rgb."""
    try:
        mi.set_variant("llvm_ad_rgb")
        dr.eval(dr.arange(mi.Float, 2) + 1)
    except Exception:
        mi.set_variant("scalar_rgb")


_variant()


def version():
    return f"{mi.__version__} {mi.variant()}"


def _material(given):
    kind, color = given["kind"], {"type": "rgb", "value": list(given["color"])}
    if kind == "glass":
        return {"type": "dielectric", "int_ior": given["ior"], "ext_ior": 1.0}
    if kind == "metal" or kind == "glossy" or given["coat"] or any(given["sheen"]):
        return {"type": "twosided", "nested": {
            "type": "principled", "base_color": color, "metallic": 1.0 if kind == "metal" else 0.0,
            "roughness": given["roughness"], "clearcoat": given["coat"], "clearcoat_gloss": 1.0,
            "specular": 0.5 if kind != "matte" else 0.0,
            "sheen": max(given["sheen"]),
        }}  # fmt: skip
    return {"type": "twosided", "nested": {"type": "diffuse", "reflectance": color}}


def _mesh(given, number):
    vertices, triangles, normals = given["vertices"], given["triangles"], given["normals"]
    # The properties replace the defaults of a mesh that is made in code.
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(_material(given["material"]))
    if any(given["material"]["glow"]):
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": list(given["material"]["glow"])}})
    mesh = mi.Mesh(f"shape{number}", len(vertices), len(triangles), has_vertex_normals=normals is not None, props=properties)
    changed = mi.traverse(mesh)
    changed["vertex_positions"] = mi.Float(vertices.astype(np.float32).ravel())
    if normals is not None:
        changed["vertex_normals"] = mi.Float(normals.astype(np.float32).ravel())
    changed["faces"] = mi.UInt32(triangles.astype(np.uint32).ravel())
    changed.update()
    return mesh


def _rows(light):
    """The dome's rows, and between them their means: Mitsuba's first and last stand on the poles, ours half a row away."""
    dome = dome_of(light)
    between = np.concatenate([dome[:1], (dome[:-1] + dome[1:]) / 2, dome[-1:]])
    result = np.empty((2 * len(dome) + 1, *dome.shape[1:]), np.float32)
    result[0::2], result[1::2] = between, dome
    return result


def _emitters(light):
    result = {}
    if light["dome"] is not None:
        turn = np.eye(4)
        turn[:3, :3] = light["turn"]
        result["dome"] = {"type": "envmap", "bitmap": mi.Bitmap(_rows(light)), "to_world": mi.ScalarTransform4f(turn)}
    for number, sun in enumerate(light["suns"]):
        result[f"sun{number}"] = {
            "type": "directional", "direction": [-each for each in sun["direction"]],
            "irradiance": {"type": "rgb", "value": list(sun["irradiance"])},
        }  # fmt: skip
    for number, lamp in enumerate(light["lamps"]):
        result[f"lamp{number}"] = {"type": "point", "position": list(lamp["position"]), "intensity": {"type": "rgb", "value": list(lamp["intensity"])}}
    return result


class State:
    pass


def build(scene):
    state = State()
    state.shapes = {f"shape{number}": _mesh(each, number) for number, each in enumerate(scene["shapes"])}
    depth = -1 if scene["bounces"] is None else scene["bounces"] + 2
    if any(each["material"]["kind"] == "glass" for each in scene["shapes"]):
        depth = -1
    state.integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 5 if scene.get("roulette") else 64})
    look(state, scene["camera"])
    state.kinds = None
    relight(state, scene["light"])
    state.seed = 0
    return state


def relight(state, light):
    """Changes the emitters of the scene that is there where it has the same ones: their kernels stay compiled."""
    kinds = (light["dome"] is None or light["dome"].shape, len(light["suns"]), len(light["lamps"]))
    if kinds != state.kinds:
        state.scene = mi.load_dict({"type": "scene", **state.shapes, **_emitters(light)})
        state.kinds = kinds
        return
    changed = mi.traverse(state.scene)
    if light["dome"] is not None:
        dome = _rows(light)
        changed["dome.data"] = mi.TensorXf(np.concatenate([dome[:, -1:], dome, dome[:, :1]], axis=1))
        turn = np.eye(4)
        turn[:3, :3] = light["turn"]
        changed["dome.to_world"] = mi.Transform4f(turn)
    for number, sun in enumerate(light["suns"]):
        away = [-each for each in sun["direction"]]
        aside = [0, 1, 0] if abs(away[1]) < 0.9 * np.linalg.norm(away) else [1, 0, 0]
        changed[f"sun{number}.to_world"] = mi.Transform4f().look_at(origin=[0, 0, 0], target=away, up=aside)
        changed[f"sun{number}.irradiance.value"] = mi.Color3f(sun["irradiance"])
    for number, lamp in enumerate(light["lamps"]):
        changed[f"lamp{number}.position"] = mi.Point3f(lamp["position"])
        changed[f"lamp{number}.intensity.value"] = mi.Color3f(lamp["intensity"])
    changed.update()


def look(state, camera):
    _, up, _ = axes_of(camera)
    state.sensor = mi.load_dict({
        "type": "perspective", "fov": camera["fov"], "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(origin=camera["eye"], target=camera["target"], up=up.tolist()),
        "film": {"type": "hdrfilm", "width": camera["size"], "height": camera["size"], "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        "sampler": {"type": "independent"},
    })  # fmt: skip


def picture(state, samples):
    state.seed += 1
    return np.array(mi.render(state.scene, sensor=state.sensor, integrator=state.integrator, spp=samples, seed=state.seed))


def gradient(state, weights, samples):
    """The derivative of sum(weights * picture) by the pixels of the dome, (H, 2 H, 3)."""
    state.seed += 1
    parameters = mi.traverse(state.scene)
    name = next(each for each in parameters.keys() if each.endswith("dome.data"))
    data = dr.detach(mi.TensorXf(parameters[name]))
    dr.enable_grad(data)
    parameters[name] = data
    parameters.update()
    shown = mi.render(state.scene, parameters, sensor=state.sensor, integrator=state.integrator, spp=samples, seed=state.seed)
    dr.backward(dr.sum(shown * mi.TensorXf(weights), axis=None))
    found = np.array(dr.grad(data))[..., :3]
    # A column more at either end repeats the one at the other.
    whole = found[:, 1:-1].copy()
    whole[:, -1] += found[:, 0]
    whole[:, 0] += found[:, -1]
    between = whole[0::2] / 2
    between[[0, -1]] *= 2
    return whole[1::2] + between[:-1] + between[1:]
