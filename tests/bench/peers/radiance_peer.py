"""Radiance, through the programs of the package pyradiance: rtrace without its ambient cache."""
import os
import subprocess
import sysconfig
import tempfile

import numpy as np

from scenes import dome_of, rays_of

NAME = "Radiance"
HOME = os.path.join(sysconfig.get_paths()["purelib"], "pyradiance")
os.environ["RAYPATH"] = os.pathsep.join([".", os.path.join(HOME, "lib")])
os.environ["PATH"] = os.pathsep.join([os.path.join(HOME, "bin"), os.environ["PATH"]])  # programs call each other
#: Suns are this wide in degrees: Radiance's sources have a solid angle.
SUN_DEGREES = 0.1


def run(program, *words, data=b""):
    done = subprocess.run([os.path.join(HOME, "bin", program), *map(str, words)], input=data, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode != 0:
        raise RuntimeError(f"{program}: exit {done.returncode}: {done.stderr.decode()[-500:]}")
    return done.stdout


def version():
    return run("rtrace", "-version").decode().split("\n")[0]


def _numbers(values):
    return " ".join(f"{each:.7g}" for each in np.ravel(values))


def _material(given, name):
    kind, color = given["kind"], given["color"]
    if any(given["glow"]):
        return f"void light {name} 0 0 3 {_numbers(given['glow'])}\n"
    if kind == "glass":
        return f"void dielectric {name} 0 0 5 1 1 1 {given['ior']} 0\n"
    if given["coat"] or any(given["sheen"]):
        raise NotImplementedError("no coat and no sheen")
    alpha = given["roughness"] ** 2
    if kind == "metal":
        return f"void metal {name} 0 0 5 {_numbers(color)} 1 {alpha}\n"
    if kind == "glossy":
        return f"void plastic {name} 0 0 5 {_numbers(color)} 0.04 {alpha}\n"
    return f"void plastic {name} 0 0 5 {_numbers(color)} 0 0\n"


def _obj(given):
    lines = [f"v {_numbers(each)}" for each in given["vertices"]]
    if given["normals"] is not None:
        lines += [f"vn {_numbers(each)}" for each in given["normals"]]
        lines += ["f " + " ".join(f"{each + 1}//{each + 1}" for each in row) for row in given["triangles"]]
    else:
        lines += ["f " + " ".join(str(each + 1) for each in row) for row in given["triangles"]]
    return "\n".join(lines) + "\n"


class State:
    def path(self, name):
        return os.path.join(self.folder.name, name)


def build(scene):
    state = State()
    state.seed = 0
    state.folder = tempfile.TemporaryDirectory()
    text = ""
    for number, each in enumerate(scene["shapes"]):
        text += _material(each["material"], f"material{number}")
        if any(each["material"]["glow"]) or len(each["triangles"]) < 100:
            # The lamps of Radiance are polygons, not parts of a mesh.
            for row, triangle in enumerate(each["vertices"][each["triangles"]]):
                text += f"material{number} polygon p{number}.{row} 0 0 9 {_numbers(triangle)}\n"
            continue
        with open(state.path(f"{number}.obj"), "w") as file:
            file.write(_obj(each))
        run("obj2mesh", state.path(f"{number}.obj"), state.path(f"{number}.rtm"))
        text += f"material{number} mesh shape{number} 1 {state.path(f'{number}.rtm')} 0 0\n"
    with open(state.path("shapes.rad"), "w") as file:
        file.write(text)
    state.bounces = 16 if scene["bounces"] is None else scene["bounces"]
    state.is_glass = any(each["material"]["kind"] == "glass" for each in scene["shapes"])
    state.camera = scene["camera"]
    relight(state, scene["light"])
    return state


def relight(state, light):
    # A dome that glows counts as a bounce to Radiance, suns and lamps do not.
    state.ambient = state.bounces + (light["dome"] is not None)
    text = ""
    if light["dome"] is not None:
        dome = dome_of(light)
        height, width, _ = dome.shape
        # One column more at either side, since data are interpolated and do not go round.
        padded = np.concatenate([dome[:, -1:], dome, dome[:, :1]], axis=1)
        for channel, name in enumerate("rgb"):
            with open(state.path(f"dome.{name}.dat"), "w") as file:
                file.write(f"2\n{0.5 / height} {1 - 0.5 / height} {height}\n{-0.5 / width} {1 + 0.5 / width} {width + 2}\n")
                file.write("\n".join(_numbers(row) for row in padded[..., channel]))
        turn = np.asarray(light["turn"]).T
        with open(state.path("dome.cal"), "w") as file:
            for axis, row in zip("xyz", turn):
                file.write(f"d{axis} = {row[0]:.9g}*Dx + {row[1]:.9g}*Dy + {row[2]:.9g}*Dz;\n")
            file.write("bound(a) = if(a - 1, 1, if(-1 - a, -1, a));\n")
            file.write("u = 0.5 - atan2(dx, dz)/(2*PI);\nv = acos(bound(dy))/PI;\nsame(r,g,b) = r;\nsecond(r,g,b) = g;\nthird(r,g,b) = b;\n")
        files = " ".join(state.path(f"dome.{name}.dat") for name in "rgb")
        text += f"void colordata dome 9 same second third {files} {state.path('dome.cal')} v u 0 0\n"
        text += "dome glow sky 0 0 4 1 1 1 0\nsky source dome_source 0 0 4 0 1 0 360\n"
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEGREES / 2)))
    for number, sun in enumerate(light["suns"]):
        text += f"void light sun{number} 0 0 3 {_numbers(np.asarray(sun['irradiance']) / solid_angle)}\n"
        text += f"sun{number} source sun_source{number} 0 0 4 {_numbers(sun['direction'])} {SUN_DEGREES}\n"
    for number, lamp in enumerate(light["lamps"]):
        radius = 1e-3
        text += f"void light lamp{number} 0 0 3 {_numbers(np.asarray(lamp['intensity']) / (np.pi * radius**2))}\n"
        text += f"lamp{number} sphere lamp_sphere{number} 0 0 4 {_numbers(lamp['position'])} {radius}\n"
    with open(state.path("light.rad"), "w") as file:
        file.write(text)
    octree = run("oconv", state.path("shapes.rad"), state.path("light.rad"))
    with open(state.path("scene.oct"), "wb") as file:
        file.write(octree)


def look(state, camera):
    state.camera = camera


def picture(state, samples):
    """A pixel has up to 4 x 4 rays, which share its samples of the sky."""
    per_axis = max(1, min(4, int(samples**0.5)))
    state.seed += 1
    random = np.random.default_rng(state.seed)
    # A ray that meets the edge of two walls sees light through it.
    origin, directions = rays_of(state.camera, per_axis, random)
    rays = np.concatenate([np.broadcast_to(origin, directions.shape), directions], axis=2).reshape(-1, 6)
    each = max(1, samples // per_axis**2)
    # The programs' random numbers are the same in each run: another order of rays gives another picture.
    order = random.permutation(len(rays))
    # No ambient cache (-aa 0); of what bounces, rays of little weight go on by chance (-lr < 0), or they would be too many.
    ends = ["-lr", 64, "-lw", 1e-7] if state.bounces == 0 or state.is_glass else ["-lr", -64, "-lw", 1 / each]
    words = ["-h", "-fff", "-ab", state.ambient, "-aa", 0, "-ad", each, "-as", 0, *ends, "-ss", each, "-st", 0, "-dj", 0, "-ds", 0.05, "-dt", 0, "-n", 2]
    found = np.empty((len(rays), 3), np.float32)
    found[order] = np.frombuffer(run("rtrace", *words, state.path("scene.oct"), data=rays[order].astype(np.float32).tobytes()), np.float32).reshape(-1, 3)
    size = state.camera["size"]
    return found.reshape(size, per_axis, size, per_axis, 3).mean((1, 3))


def skies(state, weather, division):
    """(patches, hours) of a .wea file's skies, in W/(m2 sr): the ground, then Reinhart's patches."""
    with open(state.path("year.wea"), "w") as file:
        file.write(weather)
    with open(state.path("year.smx"), "wb") as file:
        file.write(run("gendaymtx", "-m", division, "-c", 1, 1, 1, "-of", state.path("year.wea")))
    with open(state.path("year.smx"), "rb") as file:
        text = file.read()
    head, values = text.split(b"\n\n", 1)
    rows = int(head.split(b"NROWS=")[1].split()[0])
    return np.frombuffer(values, np.float32).reshape(rows, -1, 3)[..., 1].copy()


def coefficients(state, sensors, division, samples):
    """Finds what each patch gives to sensors that look up (+Z)."""
    with open(state.path("sky.rad"), "w") as file:
        for name, up, bins in (("ground", -1, "u"), ("sky", 1, f"r{division}")):
            file.write(f"#@rfluxmtx u=+Y h={bins}\nvoid glow {name}_glow 0 0 4 1 1 1 0\n{name}_glow source {name} 0 0 4 0 0 {up} 180\n")
    points = "".join(f"{_numbers(each)} 0 0 1\n" for each in sensors)
    words = ["-faf", "-I+", "-ab", 12, "-ad", samples, "-lw", 0.1 / samples, "-n", 2, "-y", len(sensors)]
    with open(state.path("sensors.mtx"), "wb") as file:
        file.write(run("rfluxmtx", *words, "-", state.path("sky.rad"), "-i", state.path("scene.oct"), data=points.encode()))


def year(state, skies):
    """(hours, sensors) irradiance in W/m2, of the skies of skies()."""
    found = run("dctimestep", "-of", state.path("sensors.mtx"), state.path("year.smx"))
    return np.frombuffer(found.split(b"\n\n", 1)[1], np.float32).reshape(-1, skies.shape[1], 3)[..., 1].T.copy()
