#!/usr/bin/env bash
# PlayCanvas (glTF): a lamp of 1,000 candela is as bright as one of 2.
#
# Expected: intensities of KHR_lights_punctual keep their ratio, whatever the unit is: a lamp of 1,000 candela is 1,000 times
#           as bright as one of 1, and a sun of 50 lux 25 times as bright as one of 2.
# Found:    intensity is cut off at 2, for points, spots and suns, and nothing is said. The full number goes into `luminance`,
#           which counts when the scene has physicalUnits, and that is off by default. Files of Blender, whose lamps have
#           thousands of candela, lose nearly all of their light and all differences between lamps.
# Tried:    playcanvas 2.23.3 of npm, Node 20.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund playcanvas@2.23.3
cat >lamps.mjs <<'JAVASCRIPT'
import * as pc from 'playcanvas';

const canvas = { width: 4, height: 4, clientWidth: 4, clientHeight: 4, style: {}, addEventListener() {},
    removeEventListener() {}, getBoundingClientRect: () => ({ left: 0, top: 0, width: 4, height: 4 }) };
const options = Object.assign(new pc.AppOptions(), { graphicsDevice: new pc.NullGraphicsDevice(canvas),
    componentSystems: [pc.LightComponentSystem, pc.RenderComponentSystem],
    resourceHandlers: [pc.ContainerHandler, pc.TextureHandler] });
const app = new pc.AppBase(canvas);
app.init(options);

const lights = [{ type: 'point', intensity: 1 }, { type: 'point', intensity: 1000 }, { type: 'directional', intensity: 50 },
    { type: 'spot', intensity: 400, spot: {} }];
const corners = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
let text = JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0, 1, 2, 3, 4] }], extensionsUsed: ['KHR_lights_punctual'],
    extensions: { KHR_lights_punctual: { lights } },
    nodes: [{ mesh: 0 }, ...lights.map((_, light) => ({ name: `${light}`, extensions: { KHR_lights_punctual: { light } } }))],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }], buffers: [{ byteLength: 36 }],
});
text = text.padEnd(4 * Math.ceil(text.length / 4));
const words = (...values) => Buffer.from(new Uint32Array(values).buffer);
const glb = Buffer.concat([words(0x46546c67, 2, 28 + text.length + 36, text.length, 0x4e4f534a), Buffer.from(text),
    words(36, 0x004e4942), corners]);
const asset = new pc.Asset('lamps', 'container', { url: 'lamps.glb', filename: 'lamps.glb', contents: new Uint8Array(glb).buffer });
asset.on('error', (error) => { console.log(error); process.exit(1); });
asset.on('load', () => {
    const found = asset.resource.instantiateRenderEntity().findComponents('light');
    const intensity = found.map((light) => light.intensity), luminance = found.map((light) => Math.round(light.luminance));
    console.log('found: of', lights.map((light) => light.intensity), 'intensity', intensity, 'luminance', luminance,
        'physicalUnits', app.scene.physicalUnits);
    const is_cut = intensity.join() === '1,2,2,2' && luminance[1] === 12566 && luminance[2] === 50;
    process.exit(is_cut && !app.scene.physicalUnits ? 0 : 1);
});
app.assets.add(asset);
app.assets.load(asset);
JAVASCRIPT
node lamps.mjs
