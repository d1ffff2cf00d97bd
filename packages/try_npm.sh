#!/usr/bin/env bash
# Installs the npm package in an empty folder and lights its scene there: try_npm.sh TGZ FOLDER.
set -euo pipefail
package=$(realpath "$1")
program=$(realpath "$(dirname "${BASH_SOURCE[0]}")")/try_npm.mjs
rm -rf "$2"
mkdir -p "$2"
cd "$2"
npm init -y >/dev/null
npm install --no-audit --no-fund --loglevel=error "$package" three@0.187.0
node node_modules/relumine/example/gltf.mjs
node "$program"
