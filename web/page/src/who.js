// What lights a point: its transfer times the environment, as a picture and in words.
import {forPixels, shrunk} from './environments.js';
import {coverageOf, radianceOf} from './lights.js';

const luminance = (rgb, i) => 0.2126 * rgb[3 * i] + 0.7152 * rgb[3 * i + 1] + 0.0722 * rgb[3 * i + 2];

/** Returns the texel of a direction in a cube map of [6][R][R], faces as in cubemap/face.h. */
function texelAt([x, y, z], resolution) {
    const [ax, ay, az] = [Math.abs(x), Math.abs(y), Math.abs(z)];
    let face, u, v, most;
    if (ax >= ay && ax >= az)
        [face, most, u, v] = x > 0 ? [0, ax, z, -y] : [1, ax, -z, -y];
    else if (ay >= az)
        [face, most, u, v] = y > 0 ? [2, ay, x, -z] : [3, ay, x, z];
    else
        [face, most, u, v] = z > 0 ? [4, az, -x, -y] : [5, az, x, -y];
    const at = (value) => Math.min(Math.floor((value / most + 1) / 2 * resolution), resolution - 1);
    return (face * resolution + at(v)) * resolution + at(u);
}

function sideOf([x, y, z]) {
    if (y > 0.8)
        return 'from above';
    if (y < -0.35)
        return 'from below';
    const sides = ['front', 'front right', 'right', 'back right', 'back', 'back left', 'left', 'front left'];
    const turn = Math.round(Math.atan2(x, z) / (Math.PI / 4));
    return `from the ${sides[(turn + 8) % 8]}${y > 0.4 ? ', high' : ''}`;
}

/**
 * `transfer`: [6][R][R], 1/sr, of the point; `environment` is the composed one. Returns {picture, shares, total}: the
 * contribution of each pixel of a lat-long of 256 x 128, and who gives how much.
 */
export function contributions(transfer, resolution, environment, lights) {
    const small = shrunk(environment, 256);
    const {width, height, rgb} = small;
    const picture = new Float32Array(width * height);
    const shining = lights.filter((light) => light.on).map((light) => ({
        name: light.name, sum: 0, coverage: coverageOf(light, 360 / width),
        luminance: luminance(radianceOf(light), 0),
    }));
    const sectors = new Map();
    let total = 0;
    forPixels(width, height, (i, x, y, weight, w) => {
        const part = transfer[texelAt(w, resolution)];
        if (part <= 0)
            return;
        picture[i] = part * luminance(rgb, i);
        let given = picture[i] * weight;
        total += given;
        for (const light of shining) {
            const own = part * weight * light.coverage(w) * light.luminance;
            light.sum += own;
            given -= own;
        }
        const side = sideOf(w);
        sectors.set(side, (sectors.get(side) ?? 0) + Math.max(given, 0));
    });
    const shares = shining.map(({name, sum}) => ({name, share: sum / total}));
    for (const [side, sum] of [...sectors].sort((a, b) => b[1] - a[1]).slice(0, 3))
        shares.push({name: `Environment ${side}`, share: sum / total});
    shares.sort((a, b) => b.share - a.share);
    return {picture, width, height, small, total, shares: shares.filter(({share}) => share >= 0.01)};
}

/** Draws the contributions in warm colours over the environment in grey. */
export function drawContributions(canvas, {picture, width, height, small}) {
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext('2d');
    const image = context.createImageData(width, height);
    const sorted = Float32Array.from(picture).sort();
    const most = Math.max(sorted[Math.floor(0.998 * (sorted.length - 1))], sorted.at(-1) / 20, 1e-12);
    let mean = 0;
    forPixels(width, height, (i, x, y, weight) => { mean += weight * luminance(small.rgb, i) / (4 * Math.PI); });
    for (let i = 0; i < width * height; ++i) {
        const seen = luminance(small.rgb, i) * 0.3 / Math.max(mean, 1e-12);
        const grey = 95 * (seen / (1 + seen)) ** (1 / 2.2) + 12;
        const heat = Math.min(picture[i] / most, 1) ** 0.5;
        const warm = [255, 60 + 175 * heat, 20 + 130 * heat ** 3];
        for (let k = 0; k < 3; ++k)
            image.data[4 * i + k] = grey * (1 - heat) + warm[k] * heat;
        image.data[4 * i + 3] = 255;
    }
    context.putImageData(image, 0, 0);
}
