#!/usr/bin/env bash
# Tries the tree as on a fresh machine: a bare root file system with nothing but git, a clone of HEAD, README's two
# commands. Prints their minutes on the clock and of the processors, and what they closed with. `./dev test --system NAME`.
#
# The bare system (tests/systems/bare.sh) is left for a look until the next time. Real meshes of $RELUMINE_DATA are seen
# inside.
set -euo pipefail
name=${1:-}
root=$PWD
grep -q "^system $name " packages/versions.txt && [ -n "$name" ] || {
    echo "dev: expected --system with one of: $(awk '$1 == "system" { print $2 }' packages/versions.txt | xargs), got '$name'" >&2
    exit 2
}
[ -z "$(git status --porcelain)" ] || echo "dev: --system: what is not committed is not tried" >&2

system=$(tests/systems/bare.sh "$name")
git clone -q --no-hardlinks "$root" "$system/relumine"
mkdir -p "$system/data"

# The mounts go with the process that made them.
exec unshare --mount --pid --fork --kill-child bash -s -- "$system" "${RELUMINE_DATA:-}" <<'INSIDE'
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
