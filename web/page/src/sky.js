// Environments as textures; and as a background: out of focus, as behind a photographed thing.
import * as THREE from 'three';
import {shrunk} from './environments.js';

const width = 256, blurDegrees = 5, largestHalf = 65504;

/** Blurs along rows or columns by a Gauss curve; `sigmaOf(row)` is in pixels. */
function blurred(rgb, w, h, stepX, stepY, sigmaOf) {
    const result = new Float32Array(rgb.length);
    for (let y = 0; y < h; ++y) {
        const sigma = sigmaOf(y), reach = Math.min(Math.ceil(2.5 * sigma), w / 2);
        const weights = Array.from({length: reach + 1}, (_, i) => Math.exp(-0.5 * (i / sigma) ** 2));
        const all = weights.reduce((sum, weight) => sum + 2 * weight, -weights[0]);
        for (let x = 0; x < w; ++x)
            for (let i = -reach; i <= reach; ++i) {
                const row = Math.min(Math.max(y + i * stepY, 0), h - 1), column = (x + i * stepX + w) % w;
                const weight = weights[Math.abs(i)] / all, from = 3 * (row * w + column), to = 3 * (y * w + x);
                result[to] += weight * rgb[from];
                result[to + 1] += weight * rgb[from + 1];
                result[to + 2] += weight * rgb[from + 2];
            }
    }
    return result;
}

/** Looks an environment up that latLongTexture() made, turned by radians. */
export const latLongLookup = `
vec3 latLong(sampler2D map, vec3 w, float turn) {
    // +Z in the middle, +X to its left, +Y at the top.
    float longitude = atan(w.x, w.z) - turn;
    float v = acos(clamp(w.y, -1.0, 1.0)) / 3.14159265359;
    return textureLod(map, vec2(0.5 - longitude / 6.28318530718, v), 0.0).rgb;
}`;

/** Returns {data, width, height}: half floats with alpha for a texture, rows from the top. */
export function halfPixels({width: w, height: h, rgb}) {
    const data = new Uint16Array(4 * w * h), one = THREE.DataUtils.toHalfFloat(1);
    for (let i = 0; i < w * h; ++i) {
        for (let k = 0; k < 3; ++k)
            data[4 * i + k] = THREE.DataUtils.toHalfFloat(Math.min(rgb[3 * i + k], largestHalf));
        data[4 * i + 3] = one;
    }
    return {data, width: w, height: h};
}

/** A texture of what halfPixels() returned. */
export function latLongTexture({data, width: w, height: h}) {
    const texture = new THREE.DataTexture(data, w, h, THREE.RGBAFormat, THREE.HalfFloatType);
    texture.wrapS = THREE.RepeatWrapping;
    texture.minFilter = THREE.LinearFilter;
    texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

/** Returns the pixels of the background. */
export function skyPixels(environment) {
    const {width: w, height: h, rgb} = shrunk(environment, width);
    const sigma = blurDegrees / 2.355 / 180 * h;
    const wide = blurred(rgb, w, h, 1, 0, (y) => sigma / Math.max(Math.sin((y + 0.5) / h * Math.PI), 0.06));
    const soft = blurred(wide, w, h, 0, 1, () => sigma);
    return halfPixels({width: w, height: h, rgb: soft});
}
