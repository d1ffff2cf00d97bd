// Environments: files become lat-longs of floats, to light with, to show and to save.
import {DataUtils, FloatType} from 'three';
import {EXRLoader} from 'three/addons/loaders/EXRLoader.js';
import {PageError} from './assets.js';
import {readHdr} from './hdr_file.js';
import {coverageOf, radianceOf} from './lights.js';

const mostPixels = 8192 * 4096;

function readExr(name, bytes) {
    let read;
    try {
        const loader = new EXRLoader();
        loader.setDataType(FloatType);
        read = loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    } catch (error) {
        const reason = String(error.message ?? error).replace(/^THREE\.EXRLoader: /, '').replace(/\.$/, '');
        throw new PageError(`${name} cannot be read: ${reason}.`);
    }
    const {width, height, data} = read;
    if (!(width > 0 && height > 0) || width * height > mostPixels)
        throw new PageError(`${name} cannot be read: expected at most 8192 x 4096 pixels.`);
    const channels = data.length / (width * height);
    const rgb = new Float32Array(3 * width * height);
    for (let y = 0; y < height; ++y) // three.js gives rows from the bottom
        for (let x = 0; x < width; ++x)
            for (let k = 0; k < 3; ++k)
                rgb[3 * (y * width + x) + k] = data[((height - 1 - y) * width + x) * channels + Math.min(k, channels - 1)];
    return {width, height, rgb};
}

/** Returns {width, height, rgb} of a .hdr or .exr file: [height][width][3] floats, the top row is +Y. */
export function readEnvironment(name, bytes) {
    const isHdr = /\.hdr$/i.test(name);
    if (!isHdr && !/\.exr$/i.test(name))
        throw new PageError(`${name}: expected a .hdr or .exr file.`);
    const picture = isHdr ? readHdr(name, bytes, mostPixels) : readExr(name, bytes);
    if (Math.abs(picture.width - 2 * picture.height) > 2)
        throw new PageError(`${name}: expected a lat-long, twice as wide as high, got ${picture.width} x ${picture.height}.`);
    const {rgb} = picture;
    for (let i = 0; i < rgb.length; ++i)
        rgb[i] = rgb[i] > 0 ? Math.min(rgb[i], 3e38) : 0;
    return picture;
}

/** Half as many pixels in each direction, while it is wider than `most`. */
export function shrunk(environment, most) {
    let {width, height, rgb} = environment;
    while (width > most && width % 2 === 0 && height % 2 === 0) {
        const half = new Float32Array(rgb.length / 4);
        const w = width / 2, h = height / 2;
        for (let y = 0; y < h; ++y)
            for (let x = 0; x < w; ++x)
                for (let k = 0; k < 3; ++k) {
                    const at = 3 * (2 * y * width + 2 * x) + k;
                    half[3 * (y * w + x) + k] = (rgb[at] + rgb[at + 3] + rgb[at + 3 * width] + rgb[at + 3 * width + 3]) / 4;
                }
        [width, height, rgb] = [w, h, half];
    }
    return {width, height, rgb};
}

/** Floats of bytes of half floats. */
export function halfNumbers(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    return Float32Array.from({length: bytes.byteLength / 2}, (_, i) => DataUtils.fromHalfFloat(view.getUint16(2 * i, true)));
}

/** Calls use(i, x, y, weight, direction) for the pixels of a lat-long; weights are solid angles. */
export function forPixels(width, height, use) {
    for (let y = 0; y < height; ++y) {
        const polar = (y + 0.5) / height * Math.PI;
        const weight = (Math.cos(y / height * Math.PI) - Math.cos((y + 1) / height * Math.PI)) * 2 * Math.PI / width;
        for (let x = 0; x < width; ++x) {
            const longitude = Math.PI * (1 - 2 * (x + 0.5) / width);
            use(y * width + x, x, y, weight, [Math.sin(polar) * Math.sin(longitude), Math.cos(polar),
                                              Math.sin(polar) * Math.cos(longitude)]);
        }
    }
}

/** The environment as the scene sees it: turned, with the lights over it. */
export function composed({width, height, rgb}, turn, lights) {
    const result = new Float32Array(rgb.length);
    const shift = Math.round(turn / 360 * width); // whole columns, as TurnedEnvironment
    const wrapped = (x) => ((x % width) + width) % width;
    const shining = lights.filter((light) => light.on)
        .map((light) => ({coverage: coverageOf(light, 360 / width), radiance: radianceOf(light)}));
    forPixels(width, height, (i, x, y, weight, w) => {
        // A turn by 90 degrees brings +Z to +X: a quarter of the picture to the left.
        const from = 3 * (y * width + wrapped(x + shift));
        for (let k = 0; k < 3; ++k)
            result[3 * i + k] = rgb[from + k];
        for (const {coverage, radiance} of shining) {
            const share = coverage(w);
            if (share > 0)
                for (let k = 0; k < 3; ++k)
                    result[3 * i + k] += share * radiance[k];
        }
    });
    return {width, height, rgb: result};
}

/** Mean irradiance over pi of a level plate: how bright the environment is. */
export function brightness({width, height, rgb}) {
    let sum = 0, weights = 0;
    forPixels(width, height, (i, x, y, weight) => {
        sum += weight * (0.2126 * rgb[3 * i] + 0.7152 * rgb[3 * i + 1] + 0.0722 * rgb[3 * i + 2]);
        weights += weight;
    });
    return sum / weights;
}

/** A small picture of a lat-long for its button, as a data URL. */
export function thumbnail(environment) {
    const small = shrunk(environment, 256);
    const canvas = document.createElement('canvas');
    canvas.width = small.width;
    canvas.height = small.height;
    const context = canvas.getContext('2d');
    const picture = context.createImageData(small.width, small.height);
    const scale = 0.35 / Math.max(brightness(small), 1e-12);
    for (let i = 0; i < small.width * small.height; ++i) {
        for (let k = 0; k < 3; ++k) {
            const value = small.rgb[3 * i + k] * scale;
            picture.data[4 * i + k] = 255 * (value / (1 + value) * 1.25) ** (1 / 2.2);
        }
        picture.data[4 * i + 3] = 255;
    }
    context.putImageData(picture, 0, 0);
    return canvas.toDataURL('image/jpeg', 0.85);
}
