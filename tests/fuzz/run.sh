#!/usr/bin/env bash
# Fuzzes: run.sh BUILD_FOLDER SECONDS [TARGET...], each target that long (all of them if none is named). Fails on a crash, a broken
# promise, a leak, an input that takes 10 s or one that takes 1 GB; what was found is in BUILD_FOLDER/found, logs are in BUILD_FOLDER/log.
# New inputs that reach new code are kept in BUILD_FOLDER/corpus. With RELUMINE_DATA, the small files of that folder are seeds, too.
set -euo pipefail
build=$1 seconds=$2
shift 2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$build"
targets=("$@")
[ $# -gt 0 ] || mapfile -t targets < <(cd "$here/corpus" && ls)

# What the scratch files of the targets are in; gone even after a crash.
TMPDIR=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo /tmp)/relumine_fuzz.XXXXXX")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
# Freed memory that the sanitizer holds back would count as the target's.
export ASAN_OPTIONS="quarantine_size_mb=16:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}"

# fuzz TARGET SECONDS: one run of libFuzzer.
fuzz() {
    local target=$1 max_len=16384
    case $target in ies | obj | mtl | off | stl | layers | lights | command_line) max_len=4096 ;; esac
    "tests/fuzz/fuzz_$target" "$PWD/corpus/$target" "$here/corpus/$target" "$TMPDIR/seeds" -max_total_time="$2" -timeout=10 \
        -rss_limit_mb=1024 -max_len="$max_len" -dict="$here/dictionaries/$target.dict" \
        -artifact_prefix="$PWD/found/$target-" -print_final_stats=1 >>"log/$target" 2>&1
}

# An input that was too slow by the clock, on a machine that had other things to do, is not if it takes less than 10 s of a processor.
was_starved() {
    local target=$1 input
    tail -n 20 "log/$target" | grep -q 'SUMMARY: libFuzzer: timeout' || return 1
    input=$(grep -oE 'Test unit written to .*' "log/$target" | tail -n 1 | cut -d ' ' -f 5)
    (ulimit -t 10 && "tests/fuzz/fuzz_$target" -timeout=0 "$input") >/dev/null 2>&1 || return 1
    rm -f "$input"
}

failed=()
for target in "${targets[@]}"; do
    [ -x "tests/fuzz/fuzz_$target" ] || { echo "no such target: $target" >&2; exit 2; }
    mkdir -p "corpus/$target" found log "$TMPDIR/seeds"
    : >"log/$target"
    if [ -d "${RELUMINE_DATA:-}" ]; then
        find "$RELUMINE_DATA" -iname "*.$target" -size -32k -exec cp -f {} "$TMPDIR/seeds" \;
    fi
    end=$((SECONDS + seconds))
    result=0
    until fuzz "$target" $((end > SECONDS ? end - SECONDS : 1)); do
        was_starved "$target" || { result=1; break; }
    done
    rm -rf "$TMPDIR/seeds"
    if [ $result -eq 0 ]; then
        printf '%-14s %s, %s\n' "$target" \
            "$(awk '/number_of_executed_units/ {sum += $2} END {print sum " runs"}' "log/$target")" \
            "$(grep -oE 'cov: [0-9]+' "log/$target" | tail -n 1)"
    else
        failed+=("$target")
        printf '%-14s FAILED: %s\n' "$target" \
            "$(grep -a -m 1 -E 'SUMMARY|ERROR|not so|runtime error|what\(\)' "log/$target" || echo "see $build/log/$target")"
    fi
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "Failed: ${failed[*]}. Inputs: $build/found; logs: $build/log" >&2
    exit 1
fi
