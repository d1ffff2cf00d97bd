#!/usr/bin/env bash
# Makes dist/: a source distribution, a wheel for each Python that is named, Blender's extension with these wheels, the npm
# package, Debian packages of this system, and checksums. `./dev release [PYTHON...]`, which builds build/release before.
# Wheels hold the program, the page of `relumine export web` and all libraries that they need, but for what every Linux of
# their age has.
#
# release.sh --try: installs each wheel, the npm package and the Debian packages of dist/ in an empty environment and lights
# a scene there. Debian packages need root, for a bare root file system.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
here=$PWD
work=$here/build/wheels
web=$here/build/release/web

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

# tried FILE WHERE: a line on what works.
tried() {
    echo "$(basename "$1"): works in an empty $2, $(stat -c %s "$1" | awk '{ printf "%.1f MB", $1 / 1e6 }')"
}

try_wheel() {
    local python
    python=$(python_of "$1")
    packages/try_wheel.sh "$1" "$python" "$work/try"
    (cd "$work/try" && bin/relumine export web knot.prt soft_boxes_latlong.exr -o site -q)
    tried "$1" "environment of $("$python" --version)"
}
try_npm() {
    packages/try_npm.sh "$1" "$work/try_npm"
    tried "$1" "npm folder"
}

if [ "${1:-}" = --try ]; then
    compgen -G 'dist/*.whl' >/dev/null || { echo "release: expected wheels in dist/; ./dev release makes them" >&2; exit 1; }
    for wheel in dist/*.whl; do try_wheel "$wheel"; done
    for package in dist/*.tgz; do try_npm "$package"; done
    packages/try_deb.sh dist
    exit
fi

[ $# -gt 0 ] || set -- python3
environment "$1" "$work/tools"
"$work/tools/bin/pip" install -q -r packages/release.pip
# Compiled anew: all files of a source distribution have one date, by which ninja would take old objects for new ones.
rm -rf dist "$work/cmake" "$work/made" "$work/source" "$work/deb"
mkdir -p dist "$work/made" "$work/source"
"$work/tools/bin/python" -m build --sdist -o dist . >"$work/sdist.log"
# From the source distribution, so that what is missing in it is seen. The libraries are compiled once, for all Pythons,
# and shared by the program and the package.
tar -xf dist/*.tar.gz -C "$work/source" --strip-components 1
libraries=$work/cmake
for python in "$@"; do
    environment "$python" "$work/maker"
    "$work/maker/bin/pip" wheel -q --no-deps -w "$work/made" "$work/source" --config-settings=build-dir="$work/cmake" \
        --config-settings=cmake.define.BUILD_SHARED_LIBS=ON --config-settings=cmake.define.RELUMINE_PAGE="$web/page"
done
for folder in files mesh cubemap lights prt relight relumine; do libraries+=:$work/cmake/$folder; done
PATH="$work/tools/bin:$PATH" LD_LIBRARY_PATH="$libraries" auditwheel repair --strip -z 9 -w dist "$work"/made/*.whl

# Blender's extension, one for each Python: two wheels in one would be too large to pass around.
extension=$work/extension
for wheel in dist/*.whl; do
    rm -rf "$extension"
    mkdir -p "$extension/wheels"
    cp integrations/blender/relumine_lights/{*.py,blender_manifest.toml} LICENSE "$extension"
    cp "$wheel" "$extension/wheels"
    sed -i '/^platforms = /a wheels = ["./wheels/'"$(basename "$wheel")"'"]' "$extension/blender_manifest.toml"
    version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$extension/blender_manifest.toml")
    abi=$(sed -E 's/.*-(cp3[0-9]+)-cp3.*/\1/' <<<"$wheel")
    (cd "$extension" && "$work/tools/bin/python" -m zipfile -c "$here/dist/relumine_lights-$version-$abi.zip" .)
done

# The npm package has a scene to begin with, which the first wheel's program makes.
environment "$1" "$work/maker"
wheels=(dist/*"$("$1" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')"-*.whl)
"$work/maker/bin/pip" install -q "${wheels[0]}"
packages/npm_package.sh "$web/package" "$work/maker/bin/relumine" "$work/npm" dist
# Of what is built: nothing else, as tests, is compiled for it.
cmake -DCMAKE_SKIP_INSTALL_ALL_DEPENDENCY=ON build/release >"$work/cmake.log"
cpack -G DEB --config build/release/CPackConfig.cmake -B "$work/deb" >"$work/cpack.log"
cp "$work"/deb/*.deb dist
lintian --fail-on error dist/*.deb
(cd dist && sha256sum -- * >SHA256SUMS)
ls -l dist
