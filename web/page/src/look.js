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

/** Returns what Stage.setMesh() takes, and `receivers`: the scene's vertex of each drawn one, or undefined. */
export async function lookOf(assets, manifest, {positions, normals, triangles}) {
    const bytes = await assets.bytes(manifest.look.file);
    const array = (name, Type) => {
        const place = manifest.look.arrays[name];
        return place && new Type(bytes.buffer.slice(bytes.byteOffset + place.offset, bytes.byteOffset + place.offset + place.bytes));
    };
    const receivers = array('receivers', Uint32Array);
    const gathered = (values) => {
        if (!receivers)
            return values;
        const result = new Float32Array(3 * receivers.length);
        receivers.forEach((vertex, i) => result.set(values.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
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
        for (const name of ['roughnessMap', 'metallicMap', 'f0Map', 'normalMap'])
            if (highlight[name])
                result[name] = await textured(highlight[name]);
        return result;
    };
    const materials = await Promise.all(manifest.look.materials.map(async ({map, highlight, ...material}) => {
        const own = map && await textured(map);
        return {...material, map: own?.texture, mapFromUv: own?.fromUv, highlight: highlight && await highlightOf(highlight)};
    }));
    return {
        receivers, materials, groups: manifest.look.groups, floor: manifest.floor, gathered,
        hasHighlights: materials.some(({highlight}) => highlight !== undefined),
        positions: gathered(positions), normals: gathered(normals), triangles: array('triangles', Uint32Array) ?? triangles,
        uvs: array('uvs', Float32Array), albedo: array('albedo', Float32Array),
    };
}
