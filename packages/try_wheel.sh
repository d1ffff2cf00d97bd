#!/usr/bin/env bash
# Installs a wheel in an empty virtual environment and lights a scene there, by the program and by the package:
# try_wheel.sh WHEEL PYTHON FOLDER. FOLDER is made anew, and left.
set -euo pipefail
wheel=$(realpath "$1")
lines=$(realpath "$(dirname "${BASH_SOURCE[0]}")")/try_wheel.py
rm -rf "$3"
"$2" -m venv "$3"
cd "$3"
bin/pip install -q --disable-pip-version-check "$wheel"
bin/relumine --version
bin/python -m relumine generate knot -o . --vertices 4000 -q
bin/relumine generate soft_boxes -o . -q
bin/relumine precompute knot.ply -o knot.prt -q
bin/relumine relight knot.prt soft_boxes_latlong.exr -o program.npy --bounces 0 -q
bin/python "$lines"
