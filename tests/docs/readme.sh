#!/usr/bin/env bash
# Runs what README.md shows, in an empty folder: every command of `relumine`, then the first Python program of each page that
# is named, with the files that these commands have made.
#   readme.sh RELUMINE SOURCE [PYTHONPATH]
set -euo pipefail
relumine=$(realpath "$1")
source=$(realpath "$2")
python=${3:+$(realpath "$3")}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export XDG_CACHE_HOME=$folder/cache PATH=$(dirname "$relumine"):$PATH

num_commands=0
while IFS= read -r command; do
    echo "+ $command"
    bash -euc "$command"
    num_commands=$((num_commands + 1))
done < <(awk '/^```/ { inside = !inside } inside && /^relumine / { sub(/ +#.*/, ""); print }' "$source/README.md")
[ "$num_commands" -ge 3 ] && [ -s knot.png ] || { echo "README.md: expected commands that make knot.png"; exit 1; }
[ -n "$python" ] || exit 0
for page in README.md docs/python.md; do
    rm -f knot.png
    awk '/^```python/ { inside = 1; next } /^```/ && inside { exit } inside' "$source/$page" >program.py
    echo "+ the first program of $page"
    PYTHONPATH=$python /usr/bin/python3 program.py
    [ -s knot.png ] || { echo "$page: expected a program that makes knot.png"; exit 1; }
done
