#!/usr/bin/env bash
# Draws every mesh or scene under every environment, without an option but the size, and puts the pictures on one page,
# FOLDER/index.html, with the exposure that was chosen under each. Scenes of meshes are kept in the cache of
# `relumine relight`.
#
#     docs/contact_sheet.sh build/release/app/relumine FOLDER MESH|SCENE.prt... -- ENV...
set -euo pipefail
relumine=$1
folder=$2
shift 2
scenes=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
    scenes+=("$1")
    shift
done
shift
mkdir -p "$folder"
{
    echo '<!doctype html><title>Contact sheet</title><style>td { font: 11px sans-serif }</style><table>'
    for environment in "$@"; do
        echo '<tr>'
        for scene in "${scenes[@]}"; do
            name=$(basename "${scene%.*}")_$(basename "${environment%.*}")
            exposure=$("$relumine" relight "$scene" "$environment" -o "$folder/$name.png" --size 240x180 --json |
                sed -n 's/.*"exposure": \([-0-9.]*\).*/\1/p')
            echo "<td><img src=\"$name.png\" width=240 height=180><br>$name, $exposure EV</td>"
        done
        echo '</tr>'
    done
    echo '</table>'
} >"$folder/index.html"
