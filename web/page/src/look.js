// What the mesh looks like besides its light: vertices as they are drawn, colours, textures.
import * as THREE from 'three';

const wraps = [THREE.RepeatWrapping, THREE.ClampToEdgeWrapping, THREE.MirroredRepeatWrapping];

async function textureOf(assets, {image, fromTop, wrap, srgb}) {
    const bytes = await assets.bytes(image);
    // The image's row 0 becomes v = 0 where uvs count from the top.
    const bitmap = await createImageBitmap(new Blob([bytes]), {
        imageOrientation: fromTop ? 'none' : 'flipY', premultiplyAlpha: 'none', colorSpaceConversion: 'none',
    });
    const texture = new THREE.Texture(bitmap);
    texture.flipY = false;
    texture.colorSpace = srgb ? THREE.SRGBColorSpace : THREE.NoColorSpace;
    [texture.wrapS, texture.wrapT] = wrap.map((kind) => wraps[kind]);
    texture.anisotropy = 8;
    texture.needsUpdate = true;
    return texture;
}

/** The mean colour of a picture, linear. */
function meanOf(bitmap, srgb) {
    const size = 16;
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = size;
    const context = canvas.getContext('2d', {willReadFrequently: true});
    context.imageSmoothingQuality = 'high';
    context.drawImage(bitmap, 0, 0, size, size);
    const {data} = context.getImageData(0, 0, size, size);
    const linear = (value) => (srgb ? new THREE.Color().setRGB(value, 0, 0, THREE.SRGBColorSpace).r : value);
    return [0, 1, 2].map((k) => {
        let sum = 0;
        for (let i = k; i < data.length; i += 4)
            sum += linear(data[i] / 255);
        return sum / size ** 2;
    });
}

/** About what part of its light each drawn vertex sends back: textures by their means, and what is mirrored. */
function shownAlbedo(albedo, triangles, groups, materials) {
    const result = albedo.slice();
    for (const {start, count, material} of groups) {
        const {mean, highlight} = materials[material];
        const f0 = highlight?.f0 ?? [0, 0, 0];
        for (let i = start; i < start + count; ++i)
            for (let k = 0; k < 3; ++k) {
                const at = 3 * triangles[i] + k;
                result[at] = Math.min(albedo[at] * mean[k] + f0[k], 1);
            }
    }
    return result;
}

/** The number of the scene's first vertices that have all of those with highlights among them. */
function numShining(receivers, triangles, groups, materials) {
    let most = -1;
    for (const {start, count, material} of groups)
        for (let i = start; materials[material].highlight && i < start + count; ++i)
            most = Math.max(most, receivers ? receivers[triangles[i]] : triangles[i]);
    return most + 1;
}

/**
 * Returns what Stage.setMesh() takes, and `receivers`: the scene's vertex of each drawn one, or undefined.
 * `gathered(values, size)` are those of the drawn ones.
 */
export async function lookOf(assets, manifest, {positions, normals, triangles}) {
    const bytes = await assets.bytes(manifest.look.file);
    const array = (name, Type) => {
        const place = manifest.look.arrays[name];
        return place && new Type(bytes.buffer.slice(bytes.byteOffset + place.offset, bytes.byteOffset + place.offset + place.bytes));
    };
    const receivers = array('receivers', Uint32Array);
    const gathered = (values, size = 3) => {
        if (!receivers)
            return values;
        const result = new Float32Array(size * receivers.length);
        receivers.forEach((vertex, i) => result.set(values.subarray(size * vertex, size * (vertex + 1)), size * i));
        return result;
    };
    const textures = new Map();
    const textured = async (map) => {
        const {channel, ...own} = map, key = JSON.stringify(own);
        if (!textures.has(key))
            textures.set(key, textureOf(assets, own));
        return {texture: await textures.get(key), fromUv: new THREE.Matrix3().fromArray(map.uv), fromTop: map.fromTop, channel};
    };
    const highlightOf = async (highlight) => {
        const result = {...highlight};
        for (const name of ['roughnessMap', 'metallicMap', 'f0Map', 'normalMap', 'glowMap'])
            if (highlight[name])
                result[name] = await textured(highlight[name]);
        return result;
    };
    const materials = await Promise.all(manifest.look.materials.map(async ({map, highlight, ...material}) => {
        const own = map && await textured(map);
        return {...material, mean: own ? meanOf(own.texture.image, map.srgb) : [1, 1, 1], map: own?.texture, mapFromUv: own?.fromUv, highlight: highlight && await highlightOf(highlight)};
    }));
    const albedo = array('albedo', Float32Array), drawn = array('triangles', Uint32Array) ?? triangles;
    return {
        receivers, materials, groups: manifest.look.groups, floor: manifest.floor, gathered,
        hasHighlights: materials.some(({highlight}) => highlight !== undefined),
        numShining: numShining(receivers, drawn, manifest.look.groups, materials),
        positions: gathered(positions), normals: gathered(normals), triangles: drawn,
        uvs: array('uvs', Float32Array), albedo, shownAlbedo: shownAlbedo(albedo, drawn, manifest.look.groups, materials),
    };
}
