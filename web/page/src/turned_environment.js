// An environment that turns about +Y: a lat-long whose columns move.
import {onFaces} from './lights.js';

const quickResolution = 64, quickWidth = 256;

export class TurnedEnvironment {
    #small;
    #places;

    constructor(latLong, width, height, resolution) {
        Object.assign(this, {latLong, width, height, resolution});
    }

    /** What Relighter.light() takes. The turn is rounded to whole columns, so that no pixel changes. */
    exact(turn) {
        const {latLong, width, height, resolution} = this;
        const shift = ((Math.round(turn / 360 * width) % width) + width) % width;
        if (shift === 0)
            return {latLong, width, height, resolution};
        // By 90 degrees +Z, the middle, comes to +X, a quarter of the picture to the left.
        const turned = new Float32Array(latLong.length);
        for (let row = 0; row < latLong.length; row += 3 * width) {
            turned.set(latLong.subarray(row + 3 * shift, row + 3 * width), row);
            turned.set(latLong.subarray(row, row + 3 * shift), row + 3 * (width - shift));
        }
        return {latLong: turned, width, height, resolution};
    }

    /** The same in a tenth of the time: a coarse cube map, looked up in a small picture. */
    quick(turn) {
        this.#small ??= this.#shrunk();
        this.#places ??= this.#placesOfTexels();
        const {rgb, width, height} = this.#small;
        const cubeMap = new Float32Array(18 * quickResolution ** 2);
        const shift = turn / 360 * width + 2 * width;
        for (let i = 0; i < this.#places.length / 2; ++i) {
            const x = this.#places[2 * i] * width - 0.5 + shift, y = this.#places[2 * i + 1] * height - 0.5;
            const column = Math.floor(x), row = Math.floor(y), s = x - column, t = y - row;
            const top = Math.max(row, 0) * width, bottom = Math.min(row + 1, height - 1) * width;
            const left = column % width, right = (column + 1) % width;
            for (let k = 0; k < 3; ++k)
                cubeMap[3 * i + k] =
                    (1 - t) * ((1 - s) * rgb[3 * (top + left) + k] + s * rgb[3 * (top + right) + k]) +
                    t * ((1 - s) * rgb[3 * (bottom + left) + k] + s * rgb[3 * (bottom + right) + k]);
        }
        return {cubeMap, resolution: quickResolution};
    }

    /** Means of whole blocks of pixels. */
    #shrunk() {
        const factor = Math.max(1, Math.floor(this.width / quickWidth));
        const width = Math.floor(this.width / factor), height = Math.floor(this.height / factor);
        const rgb = new Float32Array(3 * width * height);
        for (let y = 0; y < height * factor; ++y)
            for (let x = 0; x < width * factor; ++x) {
                const from = 3 * (y * this.width + x), to = 3 * (Math.floor(y / factor) * width + Math.floor(x / factor));
                for (let k = 0; k < 3; ++k)
                    rgb[to + k] += this.latLong[from + k] / factor ** 2;
            }
        return {rgb, width, height};
    }

    #placesOfTexels() {
        const places = new Float32Array(12 * quickResolution ** 2);
        let at = 0;
        for (const onFace of onFaces)
            for (let j = 0; j < quickResolution; ++j)
                for (let i = 0; i < quickResolution; ++i) {
                    const [x, y, z] = onFace(2 * (i + 0.5) / quickResolution - 1, 2 * (j + 0.5) / quickResolution - 1);
                    places[at++] = 0.5 - Math.atan2(x, z) / (2 * Math.PI);
                    places[at++] = Math.acos(y / Math.hypot(x, y, z)) / Math.PI;
                }
        return places;
    }
}
