#!/usr/bin/env bash
# The demo: a scene and three environments from nothing, the light transfer, pictures, an edit, the proof. Every step is a
# command that you can type yourself. Called by `./dev demo`.
set -euo pipefail
relumine=$1
folder=$2
mkdir -p "$folder"

field() { sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p" "$folder/$1.json" | head -n 1; }
# The figure between the vertices, which stands in an object of its own.
surface_field() { sed -n '/"surface": {/,/}/p' "$folder/$1.json" | sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p"; }
step() { # step NAME COMMAND...: shows the command, keeps its figures in NAME.json
    local name=$1
    shift
    echo "+ relumine $*"
    "$relumine" "$@" --json >"$folder/$name.json"
}

environments=(sun_sky soft_boxes small_light)
step scene generate colonnade -o "$folder" --vertices 50000
for environment in "${environments[@]}"; do
    step "$environment" generate "$environment" -o "$folder"
done
step precompute precompute "$folder/colonnade.ply" -o "$folder/colonnade.prt" --tolerance 0.02 --bounces
for environment in "${environments[@]}"; do
    step "relight_$environment" relight "$folder/colonnade.prt" "$folder/$environment.exr" -o "$folder/$environment.png"
    step "verify_$environment" verify "$folder/colonnade.prt" "$folder/$environment.exr" --samples 300 --bounces 0
done
# The cool fill box of the studio, four times as bright.
step edit edit "$folder/colonnade.prt" "$folder/soft_boxes.exr" --disc 0.85,0.35,0.4 --radius 25 --gain 4 -o "$folder/soft_boxes_edited.png"

ms() { awk -v s="$1" 'BEGIN { printf "%.2f ms", 1000 * s }'; }
echo
awk -v v="$(field precompute vertices)" -v c="$(field precompute clusters)" -v s="$(field precompute seconds)" -v b="$(field precompute file_bytes)" \
    'BEGIN { printf "colonnade: %d vertices, %d clusters, precomputed in %.1f s, %.1f MB\n\n", v, c, s, b / 1e6 }'
printf '| environment | bin | relight | sun traced | relative L2 error | between vertices | picture |\n|---|---|---|---|---|---|---|\n'
for environment in "${environments[@]}"; do
    printf '| %s | %s | %s | %s | %.4f | %.4f | %s |\n' "$environment" "$(ms "$(field "relight_$environment" seconds_bin)")" \
        "$(ms "$(field "relight_$environment" seconds_relight)")" "$(ms "$(field "relight_$environment" seconds_trace)")" \
        "$(field "verify_$environment" relative_l2)" "$(surface_field "verify_$environment" relative_l2)" "$folder/$environment.png"
done
printf '| soft_boxes, fill x 4 | - | %s (%s of %s clusters) | - | - | - | %s |\n' "$(ms "$(field edit seconds_edit)")" \
    "$(field edit clusters_touched)" "$(field edit clusters)" "$folder/soft_boxes_edited.png"
