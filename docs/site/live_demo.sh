#!/usr/bin/env bash
# The page on the documentation's first page: live_demo.sh PROGRAM FOLDER. A scene and environments from nothing.
set -euo pipefail
relumine=$1 folder=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$relumine" generate colonnade -o "$scratch" --vertices 30000 -q
for environment in sun_sky soft_boxes; do
    "$relumine" generate "$environment" -o "$scratch" -q
done
"$relumine" precompute "$scratch/colonnade.ply" -o "$scratch/colonnade.prt" --tolerance 0.02 --bounces -q
"$relumine" export web "$scratch/colonnade.prt" "$scratch/soft_boxes.exr" "$scratch/sun_sky.exr" -o "$folder" -q
