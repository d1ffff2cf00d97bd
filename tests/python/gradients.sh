#!/usr/bin/env bash
# Tests what differentiates with torch, as Debian has it, and with jax of pip: gradients.sh BUILD.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
build=$(realpath "$1")
export PYTHONPATH=$build/python PYTHONDONTWRITEBYTECODE=1
# tried PYTHON NAME FILE...: the tests of that name, none of which may skip itself.
tried() {
    local said
    said=$("$1" -m pytest -q -p no:cacheprovider -k "$2" "${@:3}") || { echo "$said" >&2; exit 1; }
    echo "$2: ${said##*$'\n'}"
    [[ "$said" != *skipped* ]] || { echo "gradients: expected $2 to be there" >&2; exit 1; }
}
tried /usr/bin/python3 torch "$here/test_operator.py" "$here/test_examples.py"
rm -rf "$build/gradients"
/usr/bin/python3 -m venv "$build/gradients"
"$build/gradients/bin/pip" install -q --disable-pip-version-check -r "$here/../../packages/gradients.pip"
tried "$build/gradients/bin/python" jax "$here/test_operator.py"
