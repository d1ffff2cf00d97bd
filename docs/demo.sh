#!/usr/bin/env bash
# The demo: scenes and environments from nothing. First the proof, on a knot: one light transfer, any light, errors against
# exact integration. Then a still life of gold, glass, lacquer, stone and a lamp in a studio, and while the sun moves. Every
# step is a command that you can type yourself. Called by `./dev demo`.
set -euo pipefail
relumine=$1
folder=$2
mkdir -p "$folder"

field() { sed -n "s/^  \"$2\": \([^,]*\),\{0,1\}$/\1/p" "$folder/$1.json" | head -n 1; }
# The figure of the picture, which stands in an object of its own.
of_picture() { sed -n '/"picture": {/,/}/p' "$folder/$1.json" | sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p"; }
step() { # step NAME COMMAND...: shows the command, keeps its figures in NAME.json
    local name=$1
    shift
    echo "+ relumine $*"
    "$relumine" "$@" --json >"$folder/$name.json"
}

environments=(soft_boxes sun_sky)
for environment in "${environments[@]}"; do
    step "$environment" generate "$environment" -o "$folder" --face-resolution 128
done
step knot generate knot -o "$folder" --vertices 20000
step precompute precompute "$folder/knot.ply" -o "$folder/knot.prt"
for environment in "${environments[@]}"; do
    step "relight_$environment" relight "$folder/knot.prt" "$folder/$environment.exr" -o "$folder/knot_$environment.png" --size 720x480
    step "verify_$environment" verify "$folder/knot.prt" "$folder/$environment.exr" --samples 200 --bounces 0
done
# The cool fill box of the studio, four times as bright.
step edit edit "$folder/knot.prt" "$folder/soft_boxes.exr" --disc 0.85,0.35,0.4,25 --gain 4 \
    -o "$folder/knot_soft_boxes_edited.png" --size 720x480

camera=(--eye 1.2,3.3,4.2 --target 0.05,0.4,0.15 --fov 28)
step still_life generate still_life -o "$folder" --vertices 20000
step still_life_precompute precompute "$folder/still_life.glb" -o "$folder/still_life.prt"
step still_life_soft_boxes relight "$folder/still_life.prt" "$folder/soft_boxes.exr" -o "$folder/still_life_soft_boxes.png" \
    "${camera[@]}" --size 480x320
step sun generate sequence sun -o "$folder/sun" --frames 3
step still_life_sun animate "$folder/still_life.prt" "$folder/sun/sun.%04d.exr" -o "$folder/still_life_sun.%04d.png" \
    "${camera[@]}" --size 360x240

ms() { awk -v s="$1" 'BEGIN { printf "%.1f ms", 1000 * s }'; }
echo
awk -v v="$(field precompute vertices)" -v c="$(field precompute clusters)" -v s="$(field precompute seconds)" -v b="$(field precompute file_bytes)" \
    'BEGIN { printf "knot: %d vertices, %d clusters, precomputed once in %.1f s, %.1f MB\n\n", v, c, s, b / 1e6 }'
printf '| light | relight | error at vertices | error in a picture | picture |\n|---|---|---|---|---|\n'
for environment in "${environments[@]}"; do
    printf '| %s | %s | %.4f | %.4f | %s |\n' "$environment" "$(ms "$(field "relight_$environment" seconds_relight)")" \
        "$(field "verify_$environment" relative_l2)" "$(of_picture "verify_$environment" relative_l2)" "$folder/knot_$environment.png"
done
printf '| soft_boxes, fill x 4 | %s (%s of %s clusters) | | | %s |\n' "$(ms "$(field edit seconds_edit)")" \
    "$(field edit clusters_touched)" "$(field edit clusters)" "$folder/knot_soft_boxes_edited.png"
cat <<TEXT

What it proves: one precompute serves every light, with all shadows in place; an edit costs only what it touches; and the light is
right: the errors are relative L2 against exact integration of the map with rays (\`relumine verify\`).
Materials, glass, a lamp and a sun that moves: $folder/still_life_soft_boxes.png, $folder/still_life_sun.0000.png and on.
TEXT
