#!/usr/bin/env bash
# Prints the table of docs/meshes.md: the error between the vertices, uniform against refined, at equal numbers of
# vertices. Needs the meshes and the environment of RELUMINE_DATA (docs/data.md). With a third argument it also draws
# the pictures of the box.
#
#   docs/refinement.sh build/release/app/relumine FOLDER [PICTURES]
set -euo pipefail
relumine=$1
folder=$2
pictures=${3:-}
mkdir -p "$folder"
cd "$folder"

# Of the report itself, not of the objects in it.
field() { sed -n "s/^  \"$2\": \([^,]*\),\{0,1\}$/\1/p" "$1" | head -n 1; }

"$relumine" generate colonnade -o . --vertices 5000 -q
for environment in sun_sky soft_boxes; do
    "$relumine" generate "$environment" -o . -q
done
cat >box.obj <<'BOX'
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
v 1 2 1
v -1 2 1
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
BOX
meshes=$RELUMINE_DATA/meshes/stanford
environments=(sun_sky.exr "$RELUMINE_DATA/envs/debevec/grace_cross.hdr" soft_boxes.exr)

# The mesh as it is, evenly refined and refined by light: surface errors under all environments.
row() { # row NAME MESH VERTICES OPTION...
    local name=$1 mesh=$2 vertices=$3 way cells seconds
    shift 3
    for way in before uniform refined; do
        local -a more=()
        [ "$way" = uniform ] && more=(--max-edge 1e-6 --max-vertices "$vertices")
        [ "$way" = refined ] && more=(--refine 0 --max-vertices "$vertices")
        "$relumine" precompute "$mesh" "$@" "${more[@]}" -o "$name.$way.prt" --json -q >"$name.$way.json"
        cells=
        for environment in "${environments[@]}"; do
            "$relumine" verify "$name.$way.prt" "$environment" --samples 1 --surface 500 --json -q >verify.json
            cells+=" $(sed -n '/"surface"/,$p' verify.json | sed -n 's/^ *"relative_l2": \([^,]*\),*$/\1/p' | head -n 1 |
                awk '{ printf "%.4f", $1 }') |"
        done
        seconds=$(field "$name.$way.json" seconds)
        printf '| %s, %s | %s |%s %.1f s |\n' "$name" "$way" "$(field "$name.$way.json" vertices)" "$cells" "$seconds"
    done
}

printf '| scene | vertices | sun and sky | grace | soft boxes | precompute |\n|---|---|---|---|---|---|\n'
row box box.obj 2000 --crease 40 --floor 2
row colonnade colonnade.ply 10000
row bunny "$meshes/bun_zipper_res3.ply" 6000 --floor 2
row buddha "$meshes/happy_vrip_res4.ply" 15000 --floor 2

if [ -n "$pictures" ]; then
    for way in before uniform refined; do
        "$relumine" relight "box.$way.prt" soft_boxes.exr --size 480x360 -o "$pictures/refine_box_$way.png" -q
    done
fi
