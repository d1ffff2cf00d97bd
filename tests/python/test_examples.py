"""The programs in examples/python, on a small scene."""

import json
import os
import struct
import subprocess
import sys

import pytest

import relumine
from conftest import boulder_arrays, sky_pixels

EXAMPLES = os.path.join(os.path.dirname(__file__), "../../examples/python")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("examples")
    # Fine enough to be kept as it is: fewer vertices than a coarse mesh gets.
    scene = relumine.precompute(*boulder_arrays(40), tolerance=0.1)
    sky = relumine.Environment(sky_pixels())
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    relighter.save(folder / "boulder.ply")
    scene.save(folder / "boulder.prt")
    sky.save(folder / "sky.exr")
    return folder


@pytest.mark.parametrize(
    "arguments, size",
    [
        (["relight.py", "boulder.ply", "sky.exr", "out.png"], (640, 480)),
        (["turntable.py", "boulder.prt", "sky.exr", "out.png", "2"], (480, 360)),
        (["fit_lights.py", "boulder.ply", "out.png"], (640, 240)),
        (["gradient.py", "boulder.prt", "sky.exr", "out.png"], (320, 240)),
        (["torch_gradient.py", "boulder.prt", "out.png"], (320, 240)),
        (["own_blockers.py", "out.png"], (640, 480)),
        (["error_plot.py", "boulder.ply", "sky.exr", "out.png", "20"], (720, 480)),
    ],
    ids=lambda value: value[0] if isinstance(value[0], str) else "",
)
def test_runs(files, arguments, size):
    if arguments[0] == "error_plot.py":
        pytest.importorskip("matplotlib")
    if arguments[0] == "torch_gradient.py":
        pytest.importorskip("torch")
    script = os.path.join(EXAMPLES, arguments[0])
    done = subprocess.run(
        [sys.executable, script, *arguments[1:]], cwd=files, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert struct.unpack(">II", (files / "out.png").read_bytes()[16:24]) == size


@pytest.mark.parametrize("name", [n for n in sorted(os.listdir(EXAMPLES)) if n.endswith(".py")])
def test_says_its_usage(name):
    done = subprocess.run(
        [sys.executable, os.path.join(EXAMPLES, name)], capture_output=True, text=True
    )
    assert done.returncode == 1 and done.stderr.startswith(name), done.stderr


def test_the_notebook_runs():
    with open(os.path.join(EXAMPLES, "first_steps.ipynb")) as file:
        notebook = json.load(file)
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "outputs are not kept"
            exec("".join(cell["source"]), names)
    bright = names["relighter"].picture(size=(32, 24), background="none")
    assert bright._repr_png_() is not None


def test_each_example_is_a_test():
    text = open(__file__).read()
    for name in os.listdir(EXAMPLES):
        assert name in text, name
