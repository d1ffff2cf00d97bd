#!/usr/bin/env bash
# Holds what each source pays that includes the door, relumine/relumine.h, in lines after the preprocessor: weight.sh
# COMPILER ROOT. Nearly all are of the standard library, whose strings, vectors, spans and GLM's vectors alone are some
# 37,000, so lines of our own are counted apart; all lines are held for g++ 12 alone.
set -euo pipefail
cd "$2"
read -r all own < <("$1" -std=c++20 -I. -x c++ -E relumine/relumine.h 2>/dev/null | awk '
    /^# [0-9]+ "/ { ours = $3 !~ /^"[\/<]/ || $3 ~ /^"\.\// }
    { ++all; own += ours }
    END { print all, own }')
echo "relumine.h: $all lines, $own of them Relumine's"
[ "$own" -gt 5000 ] && [ "$own" -le 9200 ] || { echo "expected 5,000 to 9,200 lines of Relumine's" >&2; exit 1; }
case $("$1" --version | head -n 1) in
*clang*) ;;
*" 12."*) [ "$all" -le 131000 ] || { echo "expected at most 131,000 lines" >&2; exit 1; } ;;
esac
