#!/usr/bin/env bash
# Makes a wheel of a finished build, as `./dev release` does but with this system's libraries, and lights a scene with it in
# an empty virtual environment: wheel.sh PYTHON BUILD WORK.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
root=$here/../..
rm -rf "$3"
mkdir -p "$3"
"$1" -m venv "$3/maker"
"$3/maker/bin/pip" wheel -q --disable-pip-version-check --no-deps -w "$3" "$root" \
    --config-settings=cmake.source-dir="$here/wheel" --config-settings=cmake.define.RELUMINE_BUILT="$(realpath "$2")" --config-settings=build-dir="$(realpath "$3")/build"
# Every source of the package is in it.
"$1" -m zipfile -l "$3"/relumine-*.whl | awk '{ print $1 }' | grep '^relumine/' | grep -v '_core\.cpython' | sort >"$3/has.txt"
(cd "$root/python" && find relumine -name '*.py' -o -name '*.pyi' -o -name py.typed) | sort | diff - "$3/has.txt"
"$root/packages/try_wheel.sh" "$3"/relumine-*.whl "$1" "$3/try"
