// What lights a point, as a picture and in words.
import {forPixels, shrunk} from './environments.js';
import {coverageOf, normalized, onFaces, radianceOf} from './lights.js';

const luminance = (rgb, i) => 0.2126 * rgb[3 * i] + 0.7152 * rgb[3 * i + 1] + 0.0722 * rgb[3 * i + 2];
const resolutionOf = (cubeMap) => Math.sqrt(cubeMap.length / 18);

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

/** Where light comes from as the eye sees it; `azimuth` is the eye's. */
function sideOf([x, y, z], azimuth) {
    if (y > 0.8)
        return 'from above';
    if (y < -0.35)
        return 'from below';
    const sides = ['front', 'front right', 'right', 'back right', 'back', 'back left', 'left', 'front left'];
    const turn = Math.round((Math.atan2(x, z) - azimuth) / (Math.PI / 4));
    return `from the ${sides[(turn + 16) % 8]}${y > 0.4 ? ', high' : ''}`;
}

/** Calls use(i, solid angle, direction) for the texels of a cube map. */
function forTexels(resolution, use) {
    let i = 0;
    for (const onFace of onFaces)
        for (let y = 0; y < resolution; ++y)
            for (let x = 0; x < resolution; ++x, ++i) {
                const place = onFace(2 * (x + 0.5) / resolution - 1, 2 * (y + 0.5) / resolution - 1);
                use(i, 4 / resolution ** 2 / Math.hypot(...place) ** 3, normalized(place));
            }
}

/**
 * `base` and `extra` are cube maps of what arrives by the environment and by the lights (or undefined). Returns what
 * a lat-long shows of them, and who gives how much: shares of the whole.
 */
export function contributions({base, extra}, environment, lights, azimuth) {
    const sectors = new Map(), given = new Map();
    let total = 0;
    forTexels(resolutionOf(base), (i, angle, w) => {
        const part = angle * luminance(base, i);
        total += part;
        const side = sideOf(w, azimuth);
        sectors.set(side, (sectors.get(side) ?? 0) + part);
    });
    if (extra) {
        const shining = lights.filter((light) => light.on).map((light) => ({
            name: light.name, coverage: coverageOf(light, 90 / resolutionOf(extra)), luminance: luminance(radianceOf(light), 0),
        }));
        forTexels(resolutionOf(extra), (i, angle, w) => {
            const part = angle * luminance(extra, i);
            if (part <= 0)
                return;
            total += part;
            const own = shining.map((light) => light.coverage(w) * light.luminance);
            const all = own.reduce((sum, value) => sum + value, 0);
            shining.forEach(({name}, k) => all > 0 && given.set(name, (given.get(name) ?? 0) + part * own[k] / all));
        });
    }
    const shares = [...given].map(([name, sum]) => ({name, share: sum / total}));
    for (const [side, sum] of [...sectors].sort((a, b) => b[1] - a[1]).slice(0, 3))
        shares.push({name: `Environment ${side}`, share: sum / total});
    shares.sort((a, b) => b.share - a.share);
    return {...pictureOf(base, extra, environment), total, shares: shares.filter(({share}) => share >= 0.01)};
}

function pictureOf(base, extra, environment) {
    const small = shrunk(environment, 256);
    const picture = new Float32Array(small.width * small.height);
    forPixels(small.width, small.height, (i, x, y, weight, w) => {
        picture[i] = luminance(base, texelAt(w, resolutionOf(base)));
        if (extra)
            picture[i] += luminance(extra, texelAt(w, resolutionOf(extra)));
    });
    return {picture, small, width: small.width, height: small.height};
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
