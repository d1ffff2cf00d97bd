#!/usr/bin/env bash
# The shared library needs libc, libm and zstd, shows the functions of its header and no others, and is small.
set -euo pipefail
library=$1
needed=$(objdump -p "$library" | awk '/NEEDED/ {print $2}' | sort | tr '\n' ' ')
[ "$needed" = "ld-linux-x86-64.so.2 libc.so.6 libm.so.6 libzstd.so.1 " ] || [ "$needed" = "libc.so.6 libm.so.6 libzstd.so.1 " ] ||
    { echo "expected libc, libm and zstd, got $needed"; exit 1; }
header=$(dirname "${BASH_SOURCE[0]}")/../../runtime/relumine_runtime.h
shown=$(nm -D --defined-only "$library" | awk '{print $3}' | sort)
declared=$(grep -oE '^RELUMINE_API .*' "$header" | grep -oE 'relumine_[a-z_]+' | sort)
[ "$shown" = "$declared" ] || { diff <(echo "$declared") <(echo "$shown"); exit 1; }
stripped=$(mktemp)
trap 'rm -f "$stripped"' EXIT
strip -o "$stripped" "$library"
size=$(stat -c %s "$stripped")
[ "$size" -le 1400000 ] || { echo "expected 1.4 MB at most without symbols, got $size bytes"; exit 1; }
