// Radiance pictures, read and written. three.js's own reader divides by 255 where the format has 256.
import {PageError} from './assets.js';

function headOf(bytes, fail) {
    let at = 0, exposure = 1;
    const line = () => {
        const start = at;
        while (at < bytes.length && bytes[at] !== 10)
            ++at;
        if (at === bytes.length || at - start > 4096)
            fail('expected a Radiance picture');
        return new TextDecoder().decode(bytes.subarray(start, at++));
    };
    if (!line().startsWith('#?'))
        fail('expected a Radiance picture');
    for (let text = line(); text !== ''; text = line()) {
        if (text.startsWith('FORMAT=') && text.trim() !== 'FORMAT=32-bit_rle_rgbe')
            fail(`expected RGBE, got ${text.slice(7)}`);
        if (text.startsWith('EXPOSURE='))
            exposure *= Number(text.slice(9));
    }
    const size = /^-Y (\d+) \+X (\d+)$/.exec(line().trim());
    if (!size)
        fail('expected rows from the top, each from the left');
    return {at, exposure: exposure > 0 ? exposure : 1, width: Number(size[2]), height: Number(size[1])};
}

/** Fills a row of [4][width]: in four runs of one channel each. Returns where the next row is. */
function readRuns(bytes, at, width, row, fail) {
    for (let channel = 0; channel < 4; ++channel)
        for (let x = 0; x < width;) {
            const count = bytes[at++];
            const isRun = count > 128, size = isRun ? count - 128 : count;
            if (!(size > 0) || x + size > width || at + (isRun ? 1 : size) > bytes.length)
                fail('expected whole rows');
            for (let i = 0; i < size; ++i)
                row[channel * width + x++] = isRun ? bytes[at] : bytes[at + i];
            at += isRun ? 1 : size;
        }
    return at;
}

/** Returns {width, height, rgb}: [height][width][3] floats. */
export function readHdr(name, bytes, mostPixels) {
    const fail = (what) => { throw new PageError(`${name} cannot be read: ${what}.`); };
    const {at: start, exposure, width, height} = headOf(bytes, fail);
    if (!(width > 0 && height > 0) || width * height > mostPixels)
        fail('expected at most 8192 x 4096 pixels');
    const rgb = new Float32Array(3 * width * height), row = new Uint8Array(4 * width);
    for (let y = 0, at = start; y < height; ++y) {
        const isPacked = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 &&
            (bytes[at + 2] << 8 | bytes[at + 3]) === width;
        if (isPacked) {
            at = readRuns(bytes, at + 4, width, row, fail);
        } else {
            if (at + 4 * width > bytes.length)
                fail('expected whole rows');
            for (let i = 0; i < 4 * width; ++i)
                row[i % 4 * width + (i >> 2)] = bytes[at + i];
            at += 4 * width;
        }
        for (let x = 0; x < width; ++x) {
            const scale = row[3 * width + x] === 0 ? 0 : 2 ** (row[3 * width + x] - 136) / exposure;
            for (let k = 0; k < 3; ++k)
                rgb[3 * (y * width + x) + k] = row[k * width + x] * scale;
        }
    }
    return {width, height, rgb};
}

/** A Radiance picture, without run lengths. */
export function hdrFile({width, height, rgb}) {
    const head = new TextEncoder().encode(`#?RADIANCE\nSOFTWARE=Relumine\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
    const bytes = new Uint8Array(head.length + 4 * width * height);
    bytes.set(head);
    for (let i = 0, at = head.length; i < width * height; ++i, at += 4) {
        const most = Math.max(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]);
        if (most < 1e-32)
            continue;
        let exponent = Math.ceil(Math.log2(most));
        if (most / 2 ** exponent * 256 >= 255.5)
            ++exponent;
        for (let k = 0; k < 3; ++k)
            bytes[at + k] = Math.min(Math.round(rgb[3 * i + k] / 2 ** exponent * 256), 255);
        bytes[at + 3] = exponent + 128;
    }
    return bytes;
}
