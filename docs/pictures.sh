#!/usr/bin/env bash
# Draws the pictures of README.md: one mesh under four photographs, plaster without an option but the size, and metal;
# those of the gallery, under two of Debevec's probes; and those of
# docs/meshes.md: a mesh as it is, refined evenly, by light, and for the sun, at equal numbers of vertices. Needs meshes
# and environments of RELUMINE_DATA (docs/data.md). FOLDER keeps the scenes.
#
#   docs/pictures.sh build/release/app/relumine FOLDER docs/pictures
set -euo pipefail
relumine=$1
folder=$2
pictures=$3
mkdir -p "$folder" "$pictures"

dragon=$RELUMINE_DATA/meshes/stanford/dragon_vrip_res2.ply
for environment in kiara_1_dawn studio_small_03; do
    "$relumine" relight "$dragon" "$RELUMINE_DATA/envs/polyhaven/${environment}_1k.hdr" --size 400x300 \
        -o "$pictures/dragon_$environment.png" -q
done
[ -f "$folder/metal.prt" ] || "$relumine" precompute "$dragon" --floor \
    --material ggx:roughness=0.25,albedo=0,f0=0.9 -o "$folder/metal.prt" -q
for environment in envs/polyhaven/rooitou_park lowpoly/kloppenheim_05; do
    "$relumine" relight "$folder/metal.prt" "$RELUMINE_DATA/${environment}_1k.hdr" --size 400x300 \
        -o "$pictures/dragon_${environment##*/}.png" -q
done
"$relumine" relight "$folder/metal.prt" "$RELUMINE_DATA/envs/debevec/uffizi_latlong_1200.hdr" --size 400x300 \
    -o "$pictures/dragon_uffizi.png" -q
"$relumine" relight "$RELUMINE_DATA/meshes/stanford/bun_zipper.ply" "$RELUMINE_DATA/envs/debevec/stpeters_cross.hdr" \
    --size 400x300 -o "$pictures/bunny_stpeters.png" -q

for environment in sun_sky soft_boxes; do
    "$relumine" generate "$environment" -o "$folder" -q
done
cat >"$folder/box.obj" <<'BOX'
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

# Shadows of the sun as the vertices have them; pictures trace them at pixels otherwise.
draw() { # draw NAME ENVIRONMENT MESH VERTICES OPTION...
    local name=$1 environment=$2 mesh=$3 vertices=$4 way
    shift 4
    for way in before uniform refined sun; do
        local -a more=(--refine off)
        [ "$way" = uniform ] && more=(--max-edge 1e-6 --vertices "$vertices")
        [ "$way" = refined ] && more=(--refine 0 --vertices "$vertices")
        [ "$way" = sun ] && more=(--refine 0 --refine-for "$folder/sun_sky.exr" --vertices "$vertices")
        [ "$way" = sun ] && [ "$environment" != sun_sky ] && continue
        "$relumine" precompute "$mesh" --floor 2 "$@" "${more[@]}" --tolerance 0.02 -o "$folder/$name.$way.prt" -q
        "$relumine" relight "$folder/$name.$way.prt" "$folder/$environment.exr" --sun vertex --size 360x270 \
            -o "$pictures/refine_${name}_$way.png" -q
    done
}

draw box soft_boxes "$folder/box.obj" 2000 --crease 40
draw bunny sun_sky "$RELUMINE_DATA/meshes/stanford/bun_zipper_res3.ply" 6000
