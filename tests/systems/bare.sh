#!/usr/bin/env bash
# Makes a bare root file system of a release of packages/versions.txt, with nothing but git, and prints its folder:
# bare.sh NAME. The system is fetched once, to $RELUMINE_SYSTEMS (~/.cache/relumine/systems), and unpacked anew each time.
set -euo pipefail
name=$1
[ "$(id -u)" -eq 0 ] || { echo "dev: a bare system: expected root, for debootstrap and chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "dev: a bare system: expected debootstrap (apt-get install debootstrap)" >&2; exit 1; }
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
[ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$cache/$name/etc/"
# So are certificates that this machine trusts beside the usual ones.
if compgen -G '/usr/local/share/ca-certificates/*.crt' >/dev/null; then
    cp /usr/local/share/ca-certificates/*.crt "$cache/$name/usr/local/share/ca-certificates/"
    chroot "$cache/$name" update-ca-certificates >/dev/null 2>&1
fi
echo "$cache/$name"
