#!/bin/sh
# A scene with bounces as the web takes it: make_scene.sh PROGRAM FOLDER.
set -eu
mkdir -p "$2"
"$1" generate blob -o "$2" --vertices 1500 -q
"$1" precompute "$2/blob.ply" -o "$2/blob.prt" --floor 20 --tolerance 0.05 --bounces -q
"$1" export runtime "$2/blob.prt" -o "$2/blob.relight" -q
"$1" generate still_life -o "$2" --vertices 1500 -q
"$1" precompute "$2/still_life.glb" -o "$2/still_life.prt" --refine off --tolerance 0.1 --bounces 0 -q
"$1" export runtime "$2/still_life.prt" -o "$2/still_life.relight" -q
