#!/usr/bin/env bash
# Babylon.js HDRCubeTexture: whether a panorama's sun is on the cube is luck.
#
# Expected: the faces have the light of the .hdr, at least with supersample: a texel's mean is that of the pixels it covers.
# Found:    a sun of one pixel of 1,024 x 512, moved by twelve pixels one after another, has 0 or 15 times its light on
#           faces of 64, as each texel takes the one pixel that its corner meets. With `supersample` the twelve have between
#           0 and 1.8 times: the looks are points, too, as many as there are pixels. The irradiance comes from these faces.
# Tried:    @babylonjs/core 9.35.0 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @babylonjs/core@9.35.0
cat >sun.mjs <<'JAVASCRIPT'
import { GetCubeMapTextureData } from '@babylonjs/core/Misc/HighDynamicRange/hdr.js';

const width = 1024, height = 512, row = 150;

/** A black .hdr with one pixel of 32,768. */
function panorama(column) {
    const header = new TextEncoder().encode(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
    const file = new Uint8Array(header.length + 4 * width * height);
    file.set(header);
    file.set([128, 128, 128, 144], header.length + 4 * (row * width + column));
    return file.buffer;
}

/** The light of all faces: radiance times solid angle. */
function light(faces) {
    const corner = (x, y) => Math.atan2(x * y, Math.hypot(x, y, 1)), at = (i) => 2 * i / faces.size - 1;
    let sum = 0;
    for (const name of ['right', 'left', 'up', 'down', 'front', 'back'])
        faces[name].forEach((value, k) => {
            const x = Math.floor(k / 3) % faces.size, y = Math.floor(k / 3 / faces.size);
            if (k % 3 === 0 && value > 0)
                sum += value * (corner(at(x + 1), at(y + 1)) - corner(at(x), at(y + 1)) - corner(at(x + 1), at(y)) +
                    corner(at(x), at(y)));
        });
    return sum;
}

const sun = 32768 * 2 * Math.PI / width * (Math.cos(row * Math.PI / height) - Math.cos((row + 1) * Math.PI / height));
const found = (supersample) => Array.from({ length: 12 }, (_, i) =>
    light(GetCubeMapTextureData(panorama(300 + i), 64, supersample)) / sun);
const points = found(false), many = found(true);
console.log('found:', points.map((x) => x.toFixed(1)).join(' '));
console.log('supersampled:', many.map((x) => x.toFixed(2)).join(' '));
const zeros = (list) => list.filter((x) => x === 0).length;
if (zeros(points) < 10 || Math.max(...points) < 10 || zeros(many) < 1 || Math.max(...many) < 1.5) process.exit(1);
JAVASCRIPT
node sun.mjs
