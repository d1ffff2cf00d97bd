#!/usr/bin/env bash
# Makes dist/: a source distribution, a wheel for each Python that is named, Blender's extension with these wheels, and
# checksums. `./dev release [PYTHON...]`.
# Wheels hold the program and all libraries that they need, but for what every Linux of their age has.
#
# release.sh --try: installs each wheel of dist/ in an empty environment of its Python and lights a scene there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
here=$PWD

# environment PYTHON FOLDER: an empty virtual environment.
environment() {
    rm -rf "$2"
    "$1" -m venv "$2"
}

# python_of WHEEL: the first Python here that the wheel is for, of those on the PATH.
python_of() {
    local version
    version=$(sed -E 's/.*-cp3([0-9]+)-cp3.*/3.\1/' <<<"$1")
    command -v "python$version" || { echo "release: expected python$version on the PATH for $1" >&2; return 1; }
}

if [ "${1:-}" = --try ]; then
    compgen -G 'dist/*.whl' >/dev/null || { echo "release: expected wheels in dist/; ./dev release makes them" >&2; exit 1; }
    for wheel in dist/*.whl; do
        python=$(python_of "$wheel")
        environment "$python" build/wheels/try
        build/wheels/try/bin/pip install -q "$wheel"
        (cd build/wheels/try
            bin/relumine --version
            bin/python -m relumine generate knot -o . --vertices 4000 -q
            bin/relumine generate soft_boxes -o . -q
            bin/relumine precompute knot.ply -o knot.prt -q
            bin/relumine relight knot.prt soft_boxes_latlong.exr -o program.npy --bounces 0 -q
            bin/python "$here/packages/try_wheel.py")
        echo "$(basename "$wheel"): works in an empty environment of $("$python" --version), $(stat -c %s "$wheel" | awk '{ printf "%.1f MB", $1 / 1e6 }')"
    done
    exit
fi

[ $# -gt 0 ] || set -- python3
environment "$1" build/wheels/tools
build/wheels/tools/bin/pip install -q -r packages/release.pip
rm -rf dist build/wheels/made
mkdir -p dist build/wheels/made
build/wheels/tools/bin/python -m build --sdist -o dist . >build/wheels/sdist.log
# From the source distribution, so that what is missing in it is seen.
for python in "$@"; do
    environment "$python" build/wheels/maker
    build/wheels/maker/bin/pip wheel -q --no-deps -w build/wheels/made dist/*.tar.gz
done
PATH="$PWD/build/wheels/tools/bin:$PATH" auditwheel repair --strip -z 9 -w dist build/wheels/made/*.whl

# Blender's extension has the wheels of all Pythons inside.
extension=build/wheels/extension
rm -rf "$extension"
mkdir -p "$extension/wheels"
cp integrations/blender/relumine_lights/{*.py,blender_manifest.toml} LICENSE "$extension"
cp dist/*.whl "$extension/wheels"
{
    echo 'wheels = ['
    for wheel in dist/*.whl; do echo "    \"./wheels/$(basename "$wheel")\","; done
    echo ']'
} >build/wheels/list
sed -i '/^platforms = /r build/wheels/list' "$extension/blender_manifest.toml"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$extension/blender_manifest.toml")
(cd "$extension" && "$OLDPWD/build/wheels/tools/bin/python" -m zipfile -c "$OLDPWD/dist/relumine_lights-$version.zip" .)
(cd dist && sha256sum -- * >SHA256SUMS)
ls -l dist
