#!/usr/bin/env bash
# Draws the moving pictures of README.md and docs/site/gallery.md: a turntable under a turning map, and an edit of the
# environment, before and after. Then docs/pictures.sh draws those that stand still. Needs meshes and environments of
# RELUMINE_DATA (docs/data.md); a picture whose data is missing is left out, and one line says so. FOLDER keeps the scenes.
#
#   docs/gallery.sh build/release/app/relumine FOLDER docs/pictures
set -euo pipefail
relumine=$1
folder=$2
pictures=$3
here=$(dirname "${BASH_SOURCE[0]}")
data=${RELUMINE_DATA:-}
mkdir -p "$folder" "$pictures"

# there NAME FILE...: whether the data of a picture is there.
there() {
    local name=$1 file
    shift
    for file in "$@"; do
        [ -f "$data/$file" ] && continue
        echo "without $name: \$RELUMINE_DATA/$file is missing (docs/data.md)"
        return 1
    done
}

dragon=meshes/stanford/dragon_vrip_res2.ply
park=envs/polyhaven/rooitou_park_1k.hdr
dawn=envs/polyhaven/kiara_1_dawn_1k.hdr
studio=envs/polyhaven/studio_small_03_1k.hdr

if there "the turntable" "$dragon" "$park"; then
    [ -f "$folder/metal.prt" ] || "$relumine" precompute "$data/$dragon" --floor \
        --material ggx:roughness=0.25,albedo=0,f0=0.9 -o "$folder/metal.prt" -q
    "$relumine" animate "$folder/metal.prt" "$data/$park" --turntable 16,environment --size 320x240 \
        -o "$folder/turn.%02d.png" -q
    /usr/bin/python3 "$here/animated.py" "$pictures/dragon_turning.gif" --milliseconds 150 "$folder"/turn.??.png
fi

if there "the edit" "$dragon" "$dawn"; then
    [ -f "$folder/plaster.prt" ] || "$relumine" precompute "$data/$dragon" --floor -o "$folder/plaster.prt" -q
    # One exposure for both: the edit is seen as light, not as a darker frame.
    "$relumine" relight "$folder/plaster.prt" "$data/$dawn" --size 400x300 --exposure -1.9 -o "$folder/edit_before.png" -q
    "$relumine" edit "$folder/plaster.prt" "$data/$dawn" "$here/gallery_edit.json" --size 400x300 --exposure -1.9 \
        -o "$folder/edit_after.png" -q
    /usr/bin/python3 "$here/animated.py" "$pictures/dragon_edit.gif" --milliseconds 1200 \
        "$folder/edit_before.png" "$folder/edit_after.png"
fi

if there "the still pictures" "$dragon" "$park" "$studio" "$dawn" lowpoly/kloppenheim_05_1k.hdr \
    meshes/stanford/bun_zipper.ply meshes/stanford/bun_zipper_res3.ply \
    envs/debevec/uffizi_latlong_1200.hdr envs/debevec/stpeters_cross.hdr; then
    "$here/pictures.sh" "$relumine" "$folder" "$pictures"
fi
