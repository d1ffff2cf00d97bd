#!/usr/bin/env bash
# Tries the tree as on a fresh machine: a bare root file system with nothing but git, a clone of HEAD, README's two
# commands. Prints their minutes on the clock and of the processors, and what they closed with. `./dev test --system NAME`.
#
# The bare system is made once, in $RELUMINE_SYSTEMS (~/.cache/relumine/systems), and unpacked anew each time; it is left
# there for a look until the next time. Real meshes of $RELUMINE_DATA are seen inside.
set -euo pipefail
name=${1:-}
root=$PWD
grep -q "^system $name " packages/versions.txt && [ -n "$name" ] || {
    echo "dev: expected --system with one of: $(awk '$1 == "system" { print $2 }' packages/versions.txt | xargs), got '$name'" >&2
    exit 2
}
[ "$(id -u)" -eq 0 ] || { echo "dev: --system: expected root, for debootstrap and chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "dev: --system: expected debootstrap (apt-get install debootstrap)" >&2; exit 1; }
[ -z "$(git status --porcelain)" ] || echo "dev: --system: what is not committed is not tried" >&2

cache=${RELUMINE_SYSTEMS:-${XDG_CACHE_HOME:-$HOME/.cache}/relumine/systems}
mkdir -p "$cache"
cache=$(cd "$cache" && pwd)
if [ ! -f "$cache/$name.tar" ]; then
    rm -rf "$cache/$name.new"
    debootstrap --variant=minbase --include=git,ca-certificates "$name" "$cache/$name.new" >"$cache/$name.log" 2>&1 ||
        { tail -n 5 "$cache/$name.log" >&2; exit 1; }
    tar -C "$cache/$name.new" -cf "$cache/$name.part" .
    mv "$cache/$name.part" "$cache/$name.tar"
    rm -rf "$cache/$name.new"
fi
rm -rf "${cache:?}/$name"
mkdir "$cache/$name"
tar -C "$cache/$name" -xf "$cache/$name.tar"
# The way out to the packages is this machine's.
cp /etc/resolv.conf "$cache/$name/etc/resolv.conf"
cp -r /etc/apt/apt.conf.d/. "$cache/$name/etc/apt/apt.conf.d/"
git clone -q --no-hardlinks "$root" "$cache/$name/relumine"
mkdir -p "$cache/$name/data"

# The mounts go with the process that made them.
exec unshare --mount --pid --fork --kill-child bash -s -- "$cache/$name" "${RELUMINE_DATA:-}" <<'INSIDE'
set -euo pipefail
system=$1
mount -t proc proc "$system/proc"
mount --rbind /dev "$system/dev"
mount -t sysfs sysfs "$system/sys"
mount -t tmpfs tmpfs "$system/tmp"
data=()
if [ -n "$2" ]; then
    mount --bind "$2" "$system/data"
    mount -o remount,bind,ro "$system/data"
    data=(RELUMINE_DATA=/data)
fi
status=0
for command in demo test; do
    echo "+ ./dev $command"
    start=$SECONDS before=$(awk '/^cpu / { print $2 + $3 + $4 }' /proc/stat)
    failed=0
    chroot "$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root "${data[@]}" TERM=dumb \
        sh -c "cd /relumine && ./dev $command" >"$system/$command.log" 2>&1 </dev/null || failed=1
    after=$(awk '/^cpu / { print $2 + $3 + $4 }' /proc/stat)
    tail -n "$([ "$failed" = 1 ] && echo 40 || echo 14)" "$system/$command.log"
    awk -v command="$command" -v clock=$((SECONDS - start)) -v busy=$((after - before)) -v ticks="$(getconf CLK_TCK)" -v failed="$failed" \
        'BEGIN { printf "./dev %s: %s; %.1f minutes, %.0f seconds of the processors (other programs included)\n", command, failed ? "FAILED" : "passed", clock / 60, busy / ticks }'
    [ "$failed" = 0 ] || status=1
done
echo "logs: $system/demo.log, $system/test.log"
exit "$status"
INSIDE
