"""The Blender add-on, in `blender -b`; skipped where there is no Blender."""

import os
import shutil
import subprocess
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../python"))


def test_in_blender(tmp_path):
    import relumine
    from conftest import sky_pixels

    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("there is no Blender: apt install blender")
    program = os.environ.get("RELUMINE_PROGRAM", "")
    if not os.path.exists(program):
        pytest.skip("the program was not built")
    # Blender's lat-long has its +X in the middle: the lamp comes from where the test expects it.
    relumine.Environment(sky_pixels(128)).save(
        tmp_path / "sky.exr", layout="latlong", to="blender", size=(256, 128)
    )
    addon = os.path.join(HERE, "../../integrations/blender/relumine_lights.py")
    done = subprocess.run(
        [blender, "-b", "--factory-startup", "--python-use-system-env", "--python-exit-code", "1",
         "--python", os.path.join(HERE, "in_blender.py"), "--", addon, program, str(tmp_path)],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0 and "all is well" in done.stdout, done.stdout + done.stderr
