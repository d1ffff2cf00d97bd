#!/usr/bin/env bash
# Tests stages of USD and textures of Basis with packages of pip: usd.sh BUILD.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
build=$(realpath "$1")
rm -rf "$build/usd"
/usr/bin/python3 -m venv "$build/usd"
"$build/usd/bin/pip" install -q --disable-pip-version-check -r "$here/../../packages/usd.pip"
PYTHONPATH=$build/python PYTHONDONTWRITEBYTECODE=1 RELUMINE_PROGRAM=$build/app/relumine \
    "$build/usd/bin/python" -m pytest -q -p no:cacheprovider "$here/test_usd.py" "$here/test_basis.py"
