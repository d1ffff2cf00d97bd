"""python3 -m relumine: the program `relumine` of the same installation."""

import os
import shutil
import sys
import sysconfig


def main() -> None:
    folders = os.pathsep.join([sysconfig.get_path("scripts"), os.path.dirname(sys.executable)])
    program = shutil.which("relumine", path=folders) or shutil.which("relumine")
    if program is None:
        sys.exit(f"relumine: expected the program in {folders} or on the PATH")
    os.execv(program, [program, *sys.argv[1:]])


main()
