#!/usr/bin/env bash
# Makes the npm package of what `./dev web` built, with a scene to begin with: npm_package.sh PACKAGE PROGRAM FOLDER OUT.
# FOLDER is where it is put together, OUT where the .tgz goes.
set -euo pipefail
program=$(realpath "$2") out=$(realpath "$4")
rm -rf "$3"
cp -r "$1" "$3"
"$program" generate still_life -o "$3/example" --vertices 6000 -q
cd "$3/example"
"$program" precompute still_life.glb -o scene.prt --refine off --tolerance 0.05 -q
"$program" export runtime scene.prt -o scene.relight -q
mv still_life.glb scene.glb
rm scene.prt
cd "$out"
npm pack --silent "$OLDPWD/.."
