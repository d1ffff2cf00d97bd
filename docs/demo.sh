#!/usr/bin/env bash
# The demo: a scene of materials and two environments from nothing, the light transfer, pictures, an edit, a sun that moves,
# the proof. Every step is a command that you can type yourself. Called by `./dev demo`.
set -euo pipefail
relumine=$1
folder=$2
mkdir -p "$folder"

field() { sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p" "$folder/$1.json" | head -n 1; }
# The figure of the picture, which stands in an object of its own.
of_picture() { sed -n '/"picture": {/,/}/p' "$folder/$1.json" | sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p"; }
step() { # step NAME COMMAND...: shows the command, keeps its figures in NAME.json
    local name=$1
    shift
    echo "+ relumine $*"
    "$relumine" "$@" --json >"$folder/$name.json"
}

environments=(soft_boxes sun_sky)
camera=(--eye 1.3,1.9,3.9 --target 0,0.52,0 --fov 32 --size 960x640)
step scene generate still_life -o "$folder" --vertices 30000
for environment in "${environments[@]}"; do
    step "$environment" generate "$environment" -o "$folder"
done
step precompute precompute "$folder/still_life.glb" -o "$folder/still_life.prt"
for environment in "${environments[@]}"; do
    step "relight_$environment" relight "$folder/still_life.prt" "$folder/$environment.exr" -o "$folder/$environment.png" "${camera[@]}"
    step "verify_$environment" verify "$folder/still_life.prt" "$folder/$environment.exr" --samples 100 --bounces 0
done
# The cool fill box of the studio, four times as bright.
step edit edit "$folder/still_life.prt" "$folder/soft_boxes.exr" --disc 0.85,0.35,0.4 --radius 25 --gain 4 \
    -o "$folder/soft_boxes_edited.png" "${camera[@]}"

ms() { awk -v s="$1" 'BEGIN { printf "%.1f ms", 1000 * s }'; }
echo
awk -v v="$(field precompute vertices)" -v c="$(field precompute clusters)" -v s="$(field precompute seconds)" -v b="$(field precompute file_bytes)" \
    'BEGIN { printf "still_life: %d vertices, %d clusters, precomputed once in %.1f s, %.1f MB\n\n", v, c, s, b / 1e6 }'
printf '| light | relight | sun traced | error at vertices | error in the picture | picture |\n|---|---|---|---|---|---|\n'
for environment in "${environments[@]}"; do
    printf '| %s | %s | %s | %.4f | %.4f | %s |\n' "$environment" "$(ms "$(field "relight_$environment" seconds_relight)")" \
        "$(ms "$(field "relight_$environment" seconds_trace)")" "$(field "verify_$environment" relative_l2)" \
        "$(of_picture "verify_$environment" relative_l2)" "$folder/$environment.png"
done
printf '| soft_boxes, fill x 4 | %s (%s of %s clusters) | - | - | - | %s |\n' "$(ms "$(field edit seconds_edit)")" \
    "$(field edit clusters_touched)" "$(field edit clusters)" "$folder/soft_boxes_edited.png"
cat <<'TEXT'

One precompute serves every light: `relight` is the time from a map to the light of all vertices, all shadows in place, and an
edit costs what it touches. The errors are relative L2 against exact integration of the map with rays (relumine verify).
TEXT
