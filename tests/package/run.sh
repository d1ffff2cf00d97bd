#!/usr/bin/env bash
# Builds the consumer against an installed Relumine and runs it: run.sh prefix|deb|folder|engine BUILD WORK [CMAKE_ARGS...]
#   prefix  what `cmake --install` puts into a folder
#   deb     the Debian packages that cpack makes, unpacked
#   folder  the source as a folder of the consumer's project: its own part of that is compiled, not linked
#   engine  the same in an engine with libraries of its own: all is configured, and the runtime alone, shared and
#           static; the static one is built and lights a frame
# BUILD is a finished build of Relumine, WORK a folder to be made anew. Fails where the consumer includes a header
# that is not Relumine's, GLM's, the compiler's or the C library's.
set -euo pipefail
kind=$1 build=$2 work=$3
shift 3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/consumer" && pwd)

fail() {
    echo "$*" >&2
    exit 1
}

# The packages of the headers that the consumer in a folder read, beside Relumine's, which lie in another one. Each is known.
check_headers() {
    local headers others packages wrong
    headers=$(cd "$1" && ninja -t deps CMakeFiles/consumer.dir/main.cpp.o | sed -n 's/^    //p' | xargs realpath | sort -u)
    grep -q "^$2/relumine/" <<<"$headers" || fail "no header of Relumine was read"
    others=$(grep -v -e "^$2/relumine/" -e "^$source/" <<<"$headers")
    packages=$(xargs dpkg-query -S <<<"$others" | sed 's/:.*//' | sort -u)
    echo "headers of ${packages//$'\n'/ }"
    wrong=$(grep -vE '^(libglm-dev|libc6-dev|linux-libc-dev|libstdc\+\+-[0-9]+-dev|libgcc-[0-9]+-dev|libclang-common-[0-9]+-dev)$' <<<"$packages" || true)
    [ -z "$wrong" ] || fail "the consumer read headers of ${wrong//$'\n'/ }"
}

rm -rf "$work"
mkdir -p "$work"
if [ "$kind" = folder ]; then
    cmake -S "$source" -B "$work/build" -G Ninja -DRELUMINE_FOLDER="$(realpath "$source/../../..")" "$@" >"$work/configure.log" 2>&1 ||
        { cat "$work/configure.log" >&2; exit 1; }
    cmake --build "$work/build" --target CMakeFiles/consumer.dir/main.cpp.o >"$work/build.log" || { cat "$work/build.log" >&2; exit 1; }
    check_headers "$work/build" "$(realpath "$work")/build/relumine/public"
    exit
fi
if [ "$kind" = engine ]; then
    configure() { # configure FOLDER [CMAKE_ARGS...]
        cmake -S "$source/../engine" -B "$work/$1" -G Ninja -DRELUMINE_FOLDER="$(realpath "$source/../../..")" "${@:2}" \
            >"$work/configure.log" 2>&1 || { cat "$work/configure.log" >&2; exit 1; }
    }
    configure all "$@"
    "$build/app/relumine" generate sphere -o "$work" --vertices 1000 -q
    "$build/app/relumine" precompute "$work/sphere.ply" -o "$work/sphere.prt" --tolerance 0.1 --bounces 0 -q
    for shared in ON OFF; do
        # None of what the runtime does not need is looked for, and no pkg-config.
        without=()
        for package in CLI11 draco embree GTest JPEG meshoptimizer OpenEXR OpenMesh PkgConfig TBB ZLIB; do
            without+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
        done
        configure "$shared" "$@" -DRELUMINE_BUILD_LIBRARY=OFF -DRELUMINE_BUILD_RUNTIME=ON -DRELUMINE_RUNTIME_SHARED=$shared \
            "${without[@]}"
    done
    cmake --build "$work/OFF" >"$work/build.log" || { cat "$work/build.log" >&2; exit 1; }
    "$work/OFF/frame" "$work/sphere.prt"
    exit
fi
case $kind in
prefix)
    root=$work/prefix
    cmake --install "$build" --prefix "$root" >"$work/install.log"
    ;;
deb)
    root=$work/root/usr
    cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/deb" >"$work/cpack.log" 2>&1 ||
        { cat "$work/cpack.log" >&2; exit 1; }
    for package in "$work"/deb/*.deb; do
        dpkg-deb -x "$package" "$work/root"
        name=$(dpkg-deb -f "$package" Package)
        depends=$(dpkg-deb -f "$package" Depends)
        echo "$(basename "$package") depends on $depends"
        [ -s "$root/share/doc/$name/copyright" ] && [ -s "$root/share/doc/$name/changelog.gz" ] || fail "$package: no licence"
        # The program needs libraries to run, and nothing to compile with; compiling with ours needs GLM.
        case $name in
        python3-relumine)
            [[ "$depends" != *-dev* && "$depends" == *python3-numpy* && "$depends" == *libembree* ]] ||
                fail "$package: wrong dependencies"
            ;;
        relumine) [[ "$depends" != *-dev* && "$depends" == *libembree* ]] || fail "$package: wrong dependencies" ;;
        relumine-dev) [[ ", $depends," == *", libglm-dev,"* ]] || fail "$package: no libglm-dev" ;;
        relumine-doc) [ -z "$depends" ] && [ -s "$root/share/doc/relumine/docs/library.md" ] || fail "$package: wrong" ;;
        librelumine-runtime-dev) [[ "$depends" == librelumine-runtime0* && -s "$root/include/relumine_runtime.h" ]] || fail "$package: wrong" ;;
        librelumine-runtime*) [[ "$depends" == *libzstd1* && "$depends" != *libembree* ]] || fail "$package: wrong dependencies" ;;
        *) fail "$package: unknown" ;;
        esac
    done
    ;;
*)
    fail "expected prefix or deb, got '$kind'"
    ;;
esac

# The program finds its libraries.
if [ -e "$root/bin/relumine" ]; then
    "$root/bin/relumine" --version
fi

# So does the Python package.
for python in "$root"/lib/python3*/dist-packages; do
    [ -d "$python" ] && (cd "$work" && PYTHONPATH=$python /usr/bin/python3 -c '
import relumine
print(relumine.precompute([[0, 0, 0], [0, 0, 1], [1, 0, 0]], [[0, 1, 2]]))')
done

cmake -S "$source" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$root" "$@" >"$work/configure.log" 2>&1 ||
    { cat "$work/configure.log" >&2; exit 1; }
cmake --build "$work/build" >"$work/build.log" || { cat "$work/build.log" >&2; exit 1; }
"$work/build/consumer" "$source/octahedron.off"

# Without CMake, by pkg-config, which knows where the file lies.
pkgconfig=$(dirname "$(find "$root" -name relumine.pc)")
flags() { PKG_CONFIG_PATH=$pkgconfig pkg-config --define-prefix "$@" relumine; }
compiler=c++
for argument in "$@"; do
    [[ "$argument" != -DCMAKE_CXX_COMPILER=* ]] || compiler=${argument#*=}
    [[ "$argument" != -DCMAKE_CXX_FLAGS=* ]] || read -ra options <<<"${argument#*=}"
done
# shellcheck disable=SC2046 # lists of words
"$compiler" "${options[@]}" -I"$source" "$source/main.cpp" $(flags --cflags --libs) -o "$work/by_pkg_config"
"$work/by_pkg_config" "$source/octahedron.off"

# Aligned vectors would be read with the wrong layout.
# shellcheck disable=SC2046
if "$compiler" -fsyntax-only -DGLM_FORCE_INTRINSICS -DGLM_FORCE_DEFAULT_ALIGNED_GENTYPES -I"$source" "$source/main.cpp" $(flags --cflags) \
    2>"$work/aligned.log"; then
    fail "aligned vectors compile"
fi
grep -q "vectors without alignment" "$work/aligned.log" || fail "$(cat "$work/aligned.log")"

# An older language is refused in one line, by whichever header comes first.
for header in relumine.h cubemap/kelvin.h; do
    # shellcheck disable=SC2046
    if echo "#include \"relumine/$header\"" | "$compiler" -fsyntax-only -x c++ - $(flags --cflags) -std=c++17 2>"$work/older.log"; then
        fail "$header: C++17 compiles"
    fi
    [ "$(grep -c 'error:' "$work/older.log")" -eq 2 ] && grep -m 1 'error:' "$work/older.log" | grep -q 'Relumine needs C++20: compile with -std=c++20' ||
        fail "$header: $(cat "$work/older.log")"
done

check_headers "$work/build" "$(realpath "$root")/include"

# The runtime asks for nothing but itself, by CMake as by pkg-config.
if [ -e "$root/include/relumine_runtime.h" ]; then
    example=$source/../../../examples/runtime.c
    mkdir "$work/runtime"
    printf '%s\n' 'cmake_minimum_required(VERSION 3.24)' 'project(engine LANGUAGES C)' \
        'find_package(relumine COMPONENTS runtime REQUIRED)' "add_executable(engine $example)" \
        'target_link_libraries(engine PRIVATE relumine::runtime m)' >"$work/runtime/CMakeLists.txt"
    cmake -S "$work/runtime" -B "$work/runtime/build" -G Ninja -DCMAKE_PREFIX_PATH="$root" >"$work/runtime.log" 2>&1 &&
        cmake --build "$work/runtime/build" >>"$work/runtime.log" 2>&1 || fail "$(cat "$work/runtime.log")"
    # shellcheck disable=SC2046
    cc "$example" $(PKG_CONFIG_PATH=$pkgconfig pkg-config --define-prefix --cflags --libs relumine-runtime) -lm \
        -o "$work/runtime/by_pkg_config"
    for engine in "$work/runtime/build/engine" "$work/runtime/by_pkg_config"; do
        said=$(LD_LIBRARY_PATH=$(dirname "$(find "$root" -name librelumine_runtime.so)") "$engine" nothing.prt out.ply 2>&1 || true)
        [[ "$said" == "open: nothing.prt: cannot read"* ]] || fail "$engine: $said"
    done
fi
