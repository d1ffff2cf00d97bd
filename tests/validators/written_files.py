"""What the program writes passes the checks of others: Khronos' glTF validator, OpenEXR's tools, numpy and Pillow.

written_files.py RELUMINE FOLDER: FOLDER keeps the validator between runs. Without node or npm, 77 and a line.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image

VALIDATOR = "gltf-validator@2.0.0-dev.3.10"

CHECK = """
const validator = require('gltf-validator'), fs = require('fs'), path = require('path');
const load = uri => Promise.resolve(new Uint8Array(fs.readFileSync(path.join(process.argv[2], '..', uri))));
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])),
    {externalResourceFunction: load}).then(report => console.log(JSON.stringify(report.issues)));
"""

relumine, tools = map(lambda name: pathlib.Path(name).resolve(), sys.argv[1:])
if not shutil.which("node") or not shutil.which("npm"):
    print("expected node and npm (packages nodejs, npm)")
    sys.exit(77)
if not (tools / "node_modules" / "gltf-validator").exists():
    tools.mkdir(parents=True, exist_ok=True)
    installed = subprocess.run(["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", tools, VALIDATOR],
                               stdout=subprocess.DEVNULL)
    if installed.returncode != 0:
        print(f"expected npm to install {VALIDATOR}")
        sys.exit(77)
(tools / "check.js").write_text(CHECK)
folder = pathlib.Path(tempfile.mkdtemp(prefix="relumine-validators-"))
faults = []


def run(*words):
    subprocess.run([relumine, *words, "-q"], cwd=folder, check=True)


def check_gltf(name):
    output = subprocess.run(["node", tools / "check.js", folder / name], capture_output=True, text=True, check=True).stdout
    issues = json.loads(output)
    for message in issues["messages"]:
        # 0: error, 1: warning, 2: a remark, such as an attribute that nothing but Relumine uses.
        if message["severity"] < 2:
            faults.append(f"{name}: {message['code']} {message.get('pointer', '')} {message['message']}")


try:
    run("generate", "knot", "-o", ".", "--vertices", "1000")
    run("generate", "still_life", "-o", ".", "--vertices", "1000")
    run("generate", "sun_sky", "-o", ".", "--face-resolution", "32")
    run("precompute", "knot.ply", "-o", "knot.prt", "--refine", "off", "--tolerance", "0.1")
    for name in ("lit.glb", "lit.npy", "lit.png", "lit.exr"):
        size = ["--size", "40x30"] if name in ("lit.png", "lit.exr") else []
        run("relight", "knot.prt", "sun_sky.exr", "--exposure", "4", "-o", name, *size)
    run("mesh", "repair", "knot.ply", "-o", "repaired.glb")
    run("mesh", "repair", "still_life.glb", "-o", "materials.glb")
    run("lights", "sun_sky.exr", "-n", "8", "-o", "lights.gltf")
    run("env", "convert", "sun_sky.exr", "--to", "cube", "-o", "cube.exr")
    for name in ("lit.glb", "still_life.glb", "repaired.glb", "materials.glb", "lights.gltf"):
        check_gltf(name)
    for name in ("lit.exr", "sun_sky.exr", "cube.exr"):
        # Reads all pixels.
        tiled = subprocess.run(["exrmaketiled", folder / name, folder / "tiled.exr"], capture_output=True, text=True)
        if tiled.returncode != 0:
            faults.append(f"{name}: exrmaketiled: {tiled.stdout} {tiled.stderr}")
    radiance = np.load(folder / "lit.npy")
    if radiance.ndim != 2 or radiance.shape[1] != 3 or not np.isfinite(radiance).all():
        faults.append(f"lit.npy: got {radiance.shape}")
    with Image.open(folder / "lit.png") as picture:
        picture.verify()
finally:
    shutil.rmtree(folder)
for fault in faults[:20]:
    print(fault)
print(f"{len(faults)} faults")
sys.exit(1 if faults else 0)
