"""three-gpu-pathtracer: path tracing in a browser, Debian's Chromium without a window and without a GPU.

Its tracer by WebGL, which 0.0.26 calls deprecated: that by WebGPU ends the GPU process of a Chromium without a GPU.
"""
import base64
import functools
import http.server
import os
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from scenes import axes_of, dome_of

NAME = "three-gpu-pathtracer"
PACKAGES = ["three-gpu-pathtracer@0.0.26", "three@0.187.0", "three-mesh-bvh@0.9.17"]


def _page():
    """A browser with three_page.html, served with its packages from a folder where they are installed."""
    folder = Path.cwd() / "three-gpu-pathtracer"
    if not (folder / "node_modules" / "three-gpu-pathtracer").exists():
        folder.mkdir(exist_ok=True)
        subprocess.run(["npm", "install", "--silent", "--prefix", str(folder), *PACKAGES], check=True)
    shutil.copy(Path(__file__).with_name("three_page.html"), folder)
    http.server.SimpleHTTPRequestHandler.log_message = lambda *_: None
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    driver.set_script_timeout(3600)
    driver.get(f"http://127.0.0.1:{server.server_port}/three_page.html")
    driver.execute_async_script("const [done] = arguments, wait = () => (window.page ? done() : setTimeout(wait, 50)); wait();")
    return driver


_driver = _page()


def _call(name, *arguments):
    """What a function of the page returns."""
    found = _driver.execute_async_script(
        "const [name, given, done] = arguments;"
        "Promise.resolve().then(() => page[name](...given)).then((value) => done({ value }), (error) => done({ error: String(error.stack) }));",
        name, list(arguments),
    )  # fmt: skip
    if "error" in found:
        raise RuntimeError(found["error"] + "\n" + "\n".join(each["message"] for each in _driver.get_log("browser")))
    return found.get("value")


def version():
    return PACKAGES[0].split("@")[1]


def _text(array, kind):
    return base64.b64encode(np.ascontiguousarray(array, kind).tobytes()).decode()


def _light(light):
    result = {"suns": light["suns"], "lamps": [{name: list(value) for name, value in each.items()} for each in light["lamps"]]}
    if light["dome"] is not None:
        # The middle of three.js' picture looks along +X, ours along +Z; row 0 of its data is at the bottom.
        dome = np.roll(dome_of(light), len(dome_of(light)) // 2, axis=1)[::-1]
        result["dome"] = _text(np.concatenate([dome, np.ones_like(dome[..., :1])], axis=2), np.float32)
        result["width"] = dome.shape[1]
        turn = np.eye(4)
        turn[:3, :3] = light["turn"]
        result["turn"] = turn.ravel().tolist()
    return result


def _camera(view):
    return {**view, "up": axes_of(view)[1].tolist()}


def build(scene):
    shapes = [{
        "vertices": _text(each["vertices"], np.float32), "triangles": _text(each["triangles"], np.uint32),
        "normals": None if each["normals"] is None else _text(each["normals"], np.float32), "material": each["material"],
    } for each in scene["shapes"]]  # fmt: skip
    tracer = {"transmissiveBounces": 16, "bounces": 32, "multipleImportanceSampling": True}
    if scene["bounces"] is not None:
        # `bounces` are rays of a path. Of the dome the last surface has one of two estimates alone, which together are its
        # light: so its rays find the sky by themselves. Suns and lamps are found by the other one.
        is_dark = scene["light"]["dome"] is None and not any(any(each["material"]["glow"]) for each in scene["shapes"])
        tracer.update({"bounces": scene["bounces"] + (1 if is_dark else 2), "multipleImportanceSampling": is_dark})
    _call("build", {"shapes": shapes, "camera": _camera(scene["camera"]), "light": _light(scene["light"]), "tracer": tracer})
    return scene["camera"]["size"]


def relight(state, light):
    _call("relight", _light(light))


def look(state, camera):
    _call("look", _camera(camera))


def picture(state, samples):
    pixels = np.array(_call("picture", samples), np.float64)
    size = int(round((len(pixels) / 4) ** 0.5))
    return pixels.reshape(size, size, 4)[::-1, :, :3]
