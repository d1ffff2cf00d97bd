#!/usr/bin/env bash
# three.js (USDLoader): textures are turned the wrong way round.
#
# Expected: `inputs:rotation` of UsdTransform2d turns uvs counter-clockwise: by 90 degrees 1 0 becomes 0 1.
# Found:    the number goes into Texture.rotation as it is, which turns the picture and so its uvs the other way: 1 0 becomes
#           0 -1. A turn by 30 degrees is off by 60. Scale and translation are right as long as nothing is turned.
# Tried:    three 0.187.0, node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent --no-audit --no-fund three@0.187.0
cat >turned.mjs <<'JS'
import assert from "assert";
import * as THREE from "three";
import { USDLoader } from "three/addons/loaders/USDLoader.js";

// Pictures are not decoded: what counts is where they are looked up.
class Picture {
    listeners = {};
    addEventListener(name, call) { this.listeners[name] = call; }
    removeEventListener() {}
    set src(_) { setTimeout(() => this.listeners.load?.call(this)); }
}
globalThis.document = { createElementNS: () => new Picture() };
globalThis.self ??= globalThis;

function stage({ rotation, scale, translation }) {
    return `#usda 1.0
(
    defaultPrim = "World"
    upAxis = "Y"
)

def Xform "World"
{
    def Mesh "square" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (
            interpolation = "vertex"
        )
        rel material:binding = </World/Look>
    }
    def Material "Look"
    {
        token outputs:surface.connect = </World/Look/Surface.outputs:surface>
        def Shader "Surface"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </World/Look/Picture.outputs:rgb>
            token outputs:surface
        }
        def Shader "Picture"
        {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @picture.png@
            float2 inputs:st.connect = </World/Look/Place.outputs:result>
            float3 outputs:rgb
        }
        def Shader "Place"
        {
            uniform token info:id = "UsdTransform2d"
            float2 inputs:in.connect = </World/Look/Reader.outputs:result>
            float inputs:rotation = ${rotation}
            float2 inputs:scale = (${scale.join(", ")})
            float2 inputs:translation = (${translation.join(", ")})
            float2 outputs:result
        }
        def Shader "Reader"
        {
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "st"
            float2 outputs:result
        }
    }
}
`;
}

/** Where three.js looks the picture up at the corners, counted from its lower left as USD does. */
async function places(transform) {
    let mesh;
    new USDLoader().parse(stage(transform)).traverse((object) => (mesh = object.isMesh ? object : mesh));
    await new Promise((done) => setTimeout(done, 50));
    const { map } = mesh.material, uv = mesh.geometry.attributes.uv;
    map.updateMatrix();
    const found = [];
    for (let i = 0; i < 3; ++i) {
        const place = new THREE.Vector2(uv.getX(i), uv.getY(i)).applyMatrix3(map.matrix);
        found.push([place.x, map.flipY ? place.y : 1 - place.y]);
    }
    return found;
}

/** UsdTransform2d: scaled, turned counter-clockwise, moved. */
function expected({ rotation, scale: [sx, sy], translation: [x, y] }) {
    const c = Math.cos(rotation * Math.PI / 180), s = Math.sin(rotation * Math.PI / 180);
    return [[0, 0], [1, 0], [0, 1]].map(([u, v]) => [c * sx * u - s * sy * v + x, s * sx * u + c * sy * v + y]);
}

const round = (list) => JSON.stringify(list.map((one) => one.map((number) => +number.toFixed(3))));
const difference = async (transform) => {
    const got = await places(transform), wanted = expected(transform);
    console.log("found:", JSON.stringify(transform), "- USD", round(wanted), "- three.js", round(got));
    return Math.max(...got.flat().map((number, i) => Math.abs(number - wanted.flat()[i])));
};
assert((await difference({ rotation: 0, scale: [2, 3], translation: [0.25, 0.5] })) < 1e-6);
assert((await difference({ rotation: 90, scale: [1, 1], translation: [0, 0] })) > 1.9);
console.log("held");
JS
node turned.mjs
