// Lights drawn on a cube map: only what changed since the last time.
import {coverageOf, normalized, onFaces, radianceOf, reachOf} from './lights.js';

const block = 8;

function directionOn(face, s, t) {
    return normalized(onFaces[face](2 * s - 1, 2 * t - 1));
}

export class CubeLights {
    #drawn = [];

    constructor(resolution) {
        this.resolution = resolution;
        this.grain = 90 / resolution;
        const size = resolution / block;
        this.blocks = [];
        for (let face = 0; face < 6; ++face)
            for (let y = 0; y < size; ++y)
                for (let x = 0; x < size; ++x)
                    this.blocks.push({face, x, y, middle: directionOn(face, (x + 0.5) / size, (y + 0.5) / size)});
        // From a block's middle to its farthest corner.
        this.blockReach = Math.atan(Math.SQRT2 * block / resolution) * 180 / Math.PI;
    }

    #mark(light, marked) {
        const reach = Math.min(reachOf(light, this.grain) + this.blockReach, 180);
        const farthest = Math.cos(reach * Math.PI / 180), length = Math.hypot(...light.direction);
        for (const here of this.blocks) {
            const cosine = (here.middle[0] * light.direction[0] + here.middle[1] * light.direction[1] +
                            here.middle[2] * light.direction[2]) / length;
            if (cosine >= farthest)
                marked.add(here);
        }
    }

    /** The whole cube map. */
    whole() {
        const size = 3 * this.resolution ** 2, rgb = new Float32Array(6 * size), shining = this.#shining();
        for (let face = 0; face < 6; ++face)
            rgb.set(this.#texels(face, 0, 0, this.resolution, this.resolution, shining), face * size);
        return rgb;
    }

    #shining() {
        return this.#drawn.filter((light) => light.on)
            .map((light) => ({coverage: coverageOf(light, this.grain), radiance: radianceOf(light)}));
    }

    /** Returns rectangles [{face, x, y, width, height, rgb}] of what is new. */
    draw(lights) {
        const key = (light) => JSON.stringify(light);
        const before = new Set(this.#drawn.map(key)), now = new Set(lights.map(key));
        const marked = new Set();
        for (const light of this.#drawn)
            if (!now.has(key(light)))
                this.#mark(light, marked);
        for (const light of lights)
            if (!before.has(key(light)))
                this.#mark(light, marked);
        this.#drawn = structuredClone(lights);
        const shining = this.#shining();
        const rectangles = [];
        for (let face = 0; face < 6; ++face) {
            const own = [...marked].filter((here) => here.face === face);
            if (own.length === 0)
                continue;
            const x = Math.min(...own.map((here) => here.x)) * block, y = Math.min(...own.map((here) => here.y)) * block;
            const width = (Math.max(...own.map((here) => here.x)) + 1) * block - x;
            const height = (Math.max(...own.map((here) => here.y)) + 1) * block - y;
            rectangles.push({face, x, y, width, height, rgb: this.#texels(face, x, y, width, height, shining)});
        }
        return rectangles;
    }

    #texels(face, x, y, width, height, shining) {
        const rgb = new Float32Array(3 * width * height);
        const w = [0, 0, 0], onFace = onFaces[face];
        for (let j = 0, at = 0; j < height; ++j)
            for (let i = 0; i < width; ++i, at += 3) {
                const place = onFace(2 * (x + i + 0.5) / this.resolution - 1, 2 * (y + j + 0.5) / this.resolution - 1);
                const scale = 1 / Math.sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]);
                for (let k = 0; k < 3; ++k)
                    w[k] = scale * place[k];
                for (const {coverage, radiance} of shining) {
                    const part = coverage(w);
                    if (part > 0)
                        for (let k = 0; k < 3; ++k)
                            rgb[at + k] += part * radiance[k];
                }
            }
        return rgb;
    }
}
