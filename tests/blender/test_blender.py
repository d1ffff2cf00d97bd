"""The Blender add-on, in `blender -b`; skipped where there is no Blender.

RELUMINE_BPY: a Python that has the module bpy, to be tried instead (pip install bpy)."""

import os
import shutil
import subprocess
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../python"))


def in_blender(script, *arguments):
    """Runs a script, which says in the end that all is well. Returns what it printed."""
    script, module = os.path.join(HERE, script), os.environ.get("RELUMINE_BPY")
    blender = shutil.which("blender")
    if module:
        command = [module, script]
    elif blender is None:
        pytest.skip("there is no Blender: apt install blender")
    else:
        command = [blender, "-b", "--factory-startup", "--python-use-system-env",
                   "--python-exit-code", "1", "--python", script]  # fmt: skip
    done = subprocess.run(
        [*command, "--", *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == 0 and "all is well" in done.stdout, done.stdout + done.stderr
    return done.stdout


def test_equals_the_command_line(tmp_path):
    import relumine
    from conftest import sky_pixels

    program = os.environ.get("RELUMINE_PROGRAM", "")
    if not os.path.exists(program):
        pytest.skip("the program was not built")
    # Blender's lat-long has its +X in the middle: the lamp comes from where the test expects it.
    relumine.Environment(sky_pixels(128)).save(
        tmp_path / "sky.exr", layout="latlong", to="blender", size=(256, 128)
    )
    in_blender("in_blender.py", program, tmp_path)


def test_assets(tmp_path):
    in_blender("assets_in_blender.py", tmp_path)


def test_worlds(tmp_path):
    said = in_blender("worlds.py", tmp_path)
    # Since Blender 5 the two .exr that it saves here say that their colours are a display's.
    assert said.count("baked  ") == (13 if "worlds in Blender 5" in said else 11)


def test_an_installed_add_on(tmp_path):
    """A zip of the folder, in a clean profile, as docs/blender.md has it."""
    archive = shutil.make_archive(
        str(tmp_path / "relumine_lights"), "zip",
        os.path.join(HERE, "../../integrations/blender"), "relumine_lights",
    )  # fmt: skip
    os.environ["BLENDER_USER_RESOURCES"] = str(tmp_path / "profile")
    try:
        in_blender("installed.py", archive, tmp_path)
    finally:
        del os.environ["BLENDER_USER_RESOURCES"]
