#!/usr/bin/env bash
# Holds what the runtime's sources include, one through the other: nothing that WebAssembly's compiler or an engine that
# has zstd alone lacks. The former has no algorithms of std::ranges on Debian 12. runtime.sh ROOT.
set -euo pipefail
cd "$1"
missing='<(stop_token|tbb/|embree|OpenEXR/|Imath|CLI/|OpenMesh/|draco/|meshoptimizer)'
sources=$(sed -n '/^set(runtime_sources/,$p' runtime/sources.cmake | grep -oE '[a-z_/]+\.cpp')
[ "$(wc -w <<<"$sources")" -gt 50 ] || { echo "runtime/sources.cmake: expected sources" >&2; exit 1; }
seen=$sources new=$sources failed=0
while [ -n "$new" ]; do
    # shellcheck disable=SC2086 # lists of words
    grep -nE "^ *#include $missing|std::ranges::[a-z]" $new && failed=1
    # shellcheck disable=SC2086
    included=$(sed -nE 's/^ *#include "([^"]+)".*/\1/p' $new | sort -u | while read -r header; do [ ! -f "$header" ] || echo "$header"; done)
    new=$(comm -13 <(tr ' ' '\n' <<<"$seen" | sort -u) <(echo "$included"))
    seen=$(printf '%s\n%s\n' "$seen" "$new")
done
[ "$failed" = 0 ] || { echo "expected sources of the runtime without these" >&2; exit 1; }
echo "$(wc -w <<<"$seen") files"
