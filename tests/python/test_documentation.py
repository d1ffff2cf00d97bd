"""Docstrings that run, types that hold, a stub that says what the compiled part has."""

import doctest
import inspect
import subprocess
import sys

import numpy as np
import pytest

import relumine
from conftest import sky_pixels

PUBLIC = [getattr(relumine, name) for name in relumine.__all__]
CLASSES = [thing for thing in PUBLIC if inspect.isclass(thing)]


@pytest.fixture(scope="module")
def example_folder(tmp_path_factory, scene, sky):
    """The files that examples name."""
    folder = tmp_path_factory.mktemp("examples")
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    relighter.save(folder / "boulder.ply")
    scene.save(folder / "boulder.prt")
    sky.save(folder / "sky.exr", layout="latlong")
    for number in (1, 2, 3):
        sky.save(folder / f"sky.{number}.exr")
    return folder


FINDER = doctest.DocTestFinder()
TESTS = [
    test
    for name in relumine.__all__
    for test in FINDER.find(getattr(relumine, name), f"relumine.{name}", module=False)
    if test.examples
]


@pytest.mark.parametrize("test", TESTS, ids=lambda test: test.name)
def test_examples_run(test, example_folder, monkeypatch, scene, sky):
    monkeypatch.chdir(example_folder)
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    test.globs = {
        "relumine": relumine,
        "np": np,
        "scene": scene,
        "environment": sky,
        "relighter": relighter,
        "picture": relighter.picture(size=(64, 48)),
    }
    told = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    runner.run(test, out=told.append)
    assert runner.failures == 0, "".join(told)


def test_everything_public_says_what_it_is():
    for thing in PUBLIC:
        if callable(thing):
            assert thing.__doc__, thing
    for cls in CLASSES:
        for name, member in vars(cls).items():
            if name.startswith("_") or not (callable(member) or isinstance(member, property)):
                continue
            if issubclass(cls, tuple) or inspect.isclass(member):
                continue
            assert inspect.getdoc(member), f"{cls.__name__}.{name}"


def test_enough_has_an_example():
    assert len(TESTS) >= 15, [test.name for test in TESTS]


def mypy(*arguments):
    pytest.importorskip("mypy")
    done = subprocess.run(
        [sys.executable, "-m", *arguments], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_hold(tmp_path):
    mypy("mypy", "--strict", "--cache-dir", str(tmp_path), "-p", "relumine")


def test_the_stub_fits_the_module(tmp_path):
    config = tmp_path / "mypy.ini"
    config.write_text(f"[mypy]\ncache_dir = {tmp_path}\n")
    mypy("mypy.stubtest", "relumine._core", "--mypy-config-file", str(config))
