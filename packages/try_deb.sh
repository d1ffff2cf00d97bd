#!/usr/bin/env bash
# Installs the Debian packages of a folder in a bare root of this system, lights a scene by the program and by Python,
# compiles against the library and the runtime, and removes all of it again: try_deb.sh FOLDER. As root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
debs=$(realpath "$1")
root=$(tests/systems/bare.sh "$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)")
mkdir "$root/debs" "$root/try"
cp "$debs"/*.deb "$root/debs"
cp packages/try_wheel.py "$root/try/lines.py"
cp examples/runtime.c tests/package/consumer/octahedron.off "$root/try"
mkdir "$root/try/consumer"
cp tests/package/consumer/CMakeLists.txt tests/package/consumer/main.cpp "$root/try/consumer"
cp -r tests/package/consumer/mesh "$root/try/consumer"

# The mounts go with the process that made them.
unshare --mount --pid --fork --kill-child bash -s -- "$root" <<'OUTSIDE'
set -euo pipefail
mount -t proc proc "$1/proc"
mount --rbind /dev "$1/dev"
chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive bash -s <<'INSIDE'
set -euo pipefail
cd /try
find /usr /etc /opt -xdev | sort >before.txt
names=$(for deb in /debs/*.deb; do dpkg-deb -f "$deb" Package; done)
apt-get update -qq
try_install() { apt-get install -y -qq --no-install-recommends "$@" >install.log 2>&1 || { tail -n 20 install.log >&2; exit 1; }; }
# An engine needs the runtime's two packages alone.
try_install /debs/librelumine-runtime*.deb gcc libc6-dev pkg-config
cc runtime.c $(pkg-config --cflags --libs relumine-runtime) -lm -o engine
try_install /debs/*.deb
relumine --version
relumine generate knot -o . --vertices 4000 -q
relumine generate soft_boxes -o . -q
relumine precompute knot.ply -o knot.prt -q
relumine relight knot.prt soft_boxes_latlong.exr -o program.npy --bounces 0 -q
python3 lines.py
test -s /usr/share/doc/relumine/README.md
try_install g++ cmake make
./engine knot.prt engine.ply
cmake -S consumer -B built >cmake.log && cmake --build built >>cmake.log
built/consumer octahedron.off
apt-get purge -y -qq $names >remove.log 2>&1
left=$(find /usr /etc /opt -xdev | sort | comm -13 before.txt - | grep -i relumine || true)
[ -z "$left" ] || { echo "left behind: $left" >&2; exit 1; }
! command -v relumine
echo "installed, used and removed: $(echo $names)"
INSIDE
OUTSIDE
