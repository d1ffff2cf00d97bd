"""The programs in examples/python, on a small scene."""

import json
import os
import struct
import subprocess
import sys

import numpy as np
import pytest

import relumine
from conftest import boulder_arrays, sky_pixels

EXAMPLES = os.path.join(os.path.dirname(__file__), "../../examples/python")

#: A June morning of Milan in an EPW file: (hour, direct, diffuse).
HOURS = [(6, 210, 60), (9, 640, 110), (10, 0, 240), (12, 780, 130)]
WEATHER = "LOCATION,Milan,-,ITA,made,160800,45.0,8.0,1.0,103.0\n" + "-\n" * 7 + "".join(
    f"2025,6,21,{hour},60,-,20.0,11.0,60,101000,0,0,300,0,{direct},{diffuse}\n"
    for hour, direct, diffuse in HOURS
)
#: Two squares, one above the other.
TABLE = (
    "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "-2 0 -2\n-2 0 2\n2 0 2\n2 0 -2\n-1 1 -1\n-1 1 1\n1 1 1\n1 1 -1\n4 0 1 2 3\n4 4 5 6 7\n"
)
#: cd/m2 of Radiance's gendaymtx 6.0a for these hours: the zenith; 42 degrees high in the north, east, south and west.
RADIANCE = [
    [1263, 2059, 3352, 1584, 1510],
    [2512, 2781, 23928, 2950, 2303],
    [10265, 8484, 11230, 9137, 7879],
    [5915, 2321, 4652, 6304, 2533],
]


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
    (folder / "weather.epw").write_text(WEATHER)
    (folder / "table.ply").write_text(TABLE)
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
        (["daylight.py", "table.ply", "weather.epw", "out.png"], (960, 720)),
    ],
    ids=lambda value: value[0] if isinstance(value[0], str) else "",
)
def test_runs(files, arguments, size):
    if arguments[0] in ("error_plot.py", "daylight.py"):
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


def test_daylight_of_an_open_floor(files):
    # Without walls a floor gets what the sky and the sun send to the ground.
    sys.path.insert(0, EXAMPLES)
    try:
        import daylight
    finally:
        sys.path.remove(EXAMPLES)
    sky = daylight.Sky(*daylight.read_epw(files / "weather.epw"))
    scene = relumine.precompute([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], [[0, 1, 2], [0, 2, 3]])
    lux = daylight.relit(relumine.Relighter(scene), sky, bounces=False)
    lux = lux[:, scene.normals[:, 1] > 0]  # it has a back, too
    assert len(lux) == len(HOURS)
    np.testing.assert_allclose(lux.mean(axis=1), sky.diffuse + sky.direct * sky.sun[:, 1], rtol=0.03)
    # Luminances at the zenith and 42 degrees high in the four quarters.
    directions = [[0, 1, 0], *([np.cos(0.733) * x, np.sin(0.733), np.cos(0.733) * z] for x, z in ((0, -1), (1, 0), (0, 1), (-1, 0)))]
    grid, areas = daylight.cube_directions(64)
    near = [np.unravel_index((grid @ np.asarray(each)).argmax(), areas.shape) for each in directions]
    for hour, wanted in enumerate(RADIANCE):
        found = sky.luminance(hour, grid, areas)
        np.testing.assert_allclose([found[place] for place in near], wanted, rtol=0.05)


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
