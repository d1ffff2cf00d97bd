"""A boulder, a sky, and the scene of both: small, and made anew in each run."""

import os
import signal
import subprocess

import numpy as np
import pytest

import relumine

# A shell that starts the tests in the background has Ctrl-C ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)


def boulder_arrays(n=48):
    """A bumpy ball on a plate, so that there are shadows: vertices (N, 3), triangles (M, 3)."""
    v, u = np.meshgrid(np.linspace(0, np.pi, n), np.linspace(0, 2 * np.pi, 2 * n), indexing="ij")
    r = 1 + 0.15 * np.sin(5 * u) * np.sin(v) ** 3 + 0.1 * np.cos(4 * v)
    ball = np.stack([r * np.sin(v) * np.cos(u), r * np.cos(v), r * np.sin(v) * np.sin(u)], axis=-1)
    side = np.linspace(-3, 3, n)
    x, z = np.meshgrid(side, side, indexing="ij")
    plate = np.stack([x, np.full_like(x, -1.2), z], axis=-1)

    def grid(rows, columns, first):
        i = first + np.arange(rows * columns).reshape(rows, columns)
        a, b, c, d = i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]
        return np.concatenate(
            [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, d), (a, d, c))]
        )

    vertices = np.concatenate([ball.reshape(-1, 3), plate.reshape(-1, 3)])
    triangles = np.concatenate([grid(n, 2 * n, 0), grid(n, n, 2 * n * n)])
    return vertices, triangles


def sky_pixels(height=32):
    """A lat-long of a bright sky, a dim ground and a soft lamp towards +X, up and +Z."""
    y, x = np.mgrid[0:height, 0 : 2 * height]
    elevation = np.pi / 2 - np.pi * (y + 0.5) / height
    longitude = np.pi - 2 * np.pi * (x + 0.5) / (2 * height)
    w = np.stack(
        [
            np.cos(elevation) * np.sin(longitude),
            np.sin(elevation),
            np.cos(elevation) * np.cos(longitude),
        ],
        axis=-1,
    )
    sky = np.where(w[..., 1:2] > 0, [0.4, 0.5, 0.7], [0.1, 0.09, 0.08])
    lamp = np.clip(w @ (np.ones(3) / np.sqrt(3)), 0, 1) ** 30
    return (sky + lamp[..., None] * [6.0, 5.5, 5.0]).astype(np.float32)


@pytest.fixture(scope="session")
def arrays():
    return boulder_arrays()


@pytest.fixture(scope="session")
def scene(arrays):
    return relumine.precompute(*arrays, tolerance=0.05, bounces=False)


@pytest.fixture(scope="session")
def sky():
    return relumine.Environment(sky_pixels(), face_resolution=16)


@pytest.fixture
def relighter(scene, sky):
    result = relumine.Relighter(scene)
    result.set_environment(sky)
    return result


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder, and the present one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def command_line():
    """Runs the program; skips where it was not built."""
    program = os.environ.get("RELUMINE_PROGRAM", "")
    if not os.path.exists(program):
        pytest.skip("the program was not built")

    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)

    return run
