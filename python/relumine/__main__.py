"""python3 -m relumine: the program of the same installation, with USD and textures of Basis."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from typing import List

from . import _basis

#: Commands whose first file is a mesh. For `relight` the stage's own light stands in for ENV.
_OF_MESHES = ("relight", "precompute", "info")
_STAGES = (".usd", ".usda", ".usdc", ".usdz")


def _with_stage(program: str, arguments: List[str], index: int) -> int:
    """Runs the program with a stage as a .glb file."""
    try:
        from . import usd
    except ImportError:
        sys.exit(
            f"relumine: {arguments[index]}: expected OpenUSD's Python to read it: "
            "pip install relumine[usd]"
        )
    name = os.path.basename(arguments[index])
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, os.path.splitext(name)[0] + ".glb")
        lights = os.path.join(folder, "lights.exr")
        try:
            lines = usd._files(arguments[index], mesh, lights)
        except OSError as error:
            sys.exit(f"relumine: {error.filename}: {error.strerror}")
        for line in lines:
            print(f"relumine: {line}", file=sys.stderr)
        given = [*arguments[:index], mesh, *arguments[index + 1 :]]
        follows = index + 1 < len(arguments) and not arguments[index + 1].startswith("-")
        if arguments[0] == "relight" and not follows and os.path.exists(lights):
            given.insert(index + 1, lights)
        return subprocess.call([program, *given])


def main() -> None:
    folders = os.pathsep.join([sysconfig.get_path("scripts"), os.path.dirname(sys.executable)])
    program = shutil.which("relumine", path=folders) or shutil.which("relumine")
    if program is None:
        sys.exit(f"relumine: expected the program in {folders} or on the PATH")
    arguments = sys.argv[1:]
    if arguments and arguments[0] in _OF_MESHES:
        for index, argument in enumerate(arguments[1:], 1):
            if arguments[index - 1] == "-o":
                continue
            if argument.lower().endswith(_STAGES):
                sys.exit(_with_stage(program, arguments, index))
            with _basis.readable(argument) as (file, notes):
                for line in notes:
                    print(f"relumine: {argument}: {line}", file=sys.stderr)
                if file != argument:
                    given = [*arguments[:index], file, *arguments[index + 1 :]]
                    sys.exit(subprocess.call([program, *given]))
    os.execv(program, [program, *arguments])


main()
