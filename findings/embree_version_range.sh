#!/usr/bin/env bash
# find_package(embree 3...4) does not find Embree 4.
#
# Expected: CMake (3.19 and later) hands a range of versions to a package, and 4.3.3 lies in 3...4.
# Found:    Embree's version file asks only for the first number of the range, so the range means "3" to it:
#           4.3.3 is "considered but not accepted". Without a version, or with 4, it is found. Who takes both has
#           to ask without a version and to look at embree_VERSION.
# Tried:    libembree-dev 4.3.3+dfsg-1 of Debian 13, cmake 3.31.6-2, both of Debian 13; cmake must be installed.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
apt-get -o APT::Sandbox::User=root download -qq libembree-dev=4.3.3+dfsg-1 libembree4-4=4.3.3+dfsg-1
for package in ./*.deb; do dpkg-deb -x "$package" root; done
[ "$(dpkg-query -W -f '${Version}' cmake)" = 3.31.6-2 ]
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(range LANGUAGES C)
foreach(version "3...4" "4" "")
    unset(embree_DIR CACHE)
    find_package(embree ${version} QUIET CONFIG)
    message("asked '${version}': found ${embree_FOUND}, considered ${embree_CONSIDERED_VERSIONS}")
endforeach()
CMAKE
cmake -S . -B build -DCMAKE_PREFIX_PATH="$work/root/usr" -DCMAKE_LIBRARY_ARCHITECTURE=x86_64-linux-gnu \
    -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF >out 2>&1
grep '^asked' out
grep -q "^asked '3\.\.\.4': found 0, considered 4.3.3" out
grep -q "^asked '4': found 1, considered 4.3.3" out
grep -q "^asked '': found 1, considered 4.3.3" out
