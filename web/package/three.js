// A scene's light on an object of three.js, such as GLTFLoader gives. three.d.ts says what each function takes and returns.
import { BufferAttribute, BufferGeometry, Matrix3, Matrix4, Mesh, MeshBasicMaterial, Vector3 } from 'three';
import { RelumineError } from './wasm_module.js';

/** Receivers in cells of space. */
class Receivers {
    #positions;
    #normals;
    #first;
    #next;
    #size;

    constructor(positions, normals) {
        this.#positions = positions;
        this.#normals = normals;
        const count = positions.length / 3;
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
        positions.forEach((value, i) => {
            low[i % 3] = Math.min(low[i % 3], value);
            high[i % 3] = Math.max(high[i % 3], value);
        });
        // Files for pages keep 1/65,535 of the longest side.
        this.tolerance = 3e-5 * Math.hypot(...high.map((value, i) => value - low[i])) || 1e-9;
        this.#size = 4 * this.tolerance;
        this.#first = new Int32Array(2 ** Math.ceil(Math.log2(2 * count + 1))).fill(-1);
        this.#next = new Int32Array(count);
        for (let i = 0; i < count; ++i) {
            const cell = this.#cell(...[0, 1, 2].map((axis) => Math.floor(positions[3 * i + axis] / this.#size)));
            this.#next[i] = this.#first[cell];
            this.#first[cell] = i;
        }
    }

    #cell(x, y, z) {
        return (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) & (this.#first.length - 1);
    }

    /** The receiver at a point whose normal is nearest to this one, or -1. */
    at(point, normal) {
        const corner = [point.x, point.y, point.z].map((value) => Math.floor(value / this.#size - 0.5));
        let best = -1, most = -Infinity;
        for (let k = 0; k < 8; ++k)
            for (let i = this.#first[this.#cell(corner[0] + (k & 1), corner[1] + (k >> 1 & 1), corner[2] + (k >> 2))];
                 i >= 0; i = this.#next[i]) {
                const [x, y, z] = this.#positions.subarray(3 * i, 3 * i + 3);
                const distance = Math.hypot(x - point.x, y - point.y, z - point.z) / this.tolerance;
                if (distance > 1)
                    continue;
                const [nx, ny, nz] = this.#normals.subarray(3 * i, 3 * i + 3);
                const score = nx * normal.x + ny * normal.y + nz * normal.z - 0.1 * distance;
                if (score > most)
                    [best, most] = [i, score];
            }
        return best;
    }
}

/** The geometry with normals: three.js draws it flat where it has none. */
const withNormals = (geometry) => {
    if (geometry.getAttribute('normal'))
        return geometry;
    const flat = geometry.index ? geometry.toNonIndexed() : geometry.clone();
    flat.computeVertexNormals();
    return flat;
};

/** Calls use(vertex) for those that triangles have. */
const forVertices = (geometry, use) => {
    const seen = new Uint8Array(geometry.getAttribute('position').count);
    const count = geometry.index?.count ?? seen.length;
    for (let i = 0; i < count; ++i) {
        const vertex = geometry.index?.getX(i) ?? i;
        if (!seen[vertex])
            use(vertex);
        seen[vertex] = 1;
    }
};

export function receiversOf(object, positions, normals) {
    const receivers = new Receivers(positions, normals);
    const point = new Vector3(), normal = new Vector3(), matrix = new Matrix4(), ofNormals = new Matrix3();
    const found = [];
    let missing = 0, all = 0;
    object.updateWorldMatrix(true, true);
    const intoObject = object.matrixWorld.clone().invert();
    object.traverse((mesh) => {
        if (!mesh.isMesh)
            return;
        if (mesh.isInstancedMesh)
            throw new RelumineError('WRONG_ARGUMENT', `${mesh.name || 'a mesh'}: expected no instances, which a scene does not have`);
        const geometry = withNormals(mesh.geometry);
        matrix.multiplyMatrices(intoObject, mesh.matrixWorld);
        ofNormals.getNormalMatrix(matrix);
        const map = new Int32Array(geometry.getAttribute('position').count).fill(-1);
        const isPosed = mesh.isSkinnedMesh || mesh.morphTargetInfluences?.length > 0;
        forVertices(geometry, (vertex) => {
            if (isPosed && geometry === mesh.geometry)
                mesh.getVertexPosition(vertex, point);
            else
                point.fromBufferAttribute(geometry.getAttribute('position'), vertex);
            normal.fromBufferAttribute(geometry.getAttribute('normal'), vertex).applyMatrix3(ofNormals).normalize();
            map[vertex] = receivers.at(point.applyMatrix4(matrix), normal);
            missing += map[vertex] < 0;
            ++all;
        });
        found.push({ mesh, geometry, receivers: map });
    });
    if (missing > 0 || all === 0)
        throw new RelumineError('WRONG_ARGUMENT', `expected the object that the scene was made of: ${missing} of its ${all} vertices are not the scene's`);
    return found;
}

/** What is shown of a material: its base colour, as the object has it. */
const shown = (material) => new MeshBasicMaterial({
    name: material.name, color: material.color, map: material.map ?? null, alphaMap: material.alphaMap ?? null,
    alphaTest: material.alphaTest, transparent: material.transparent, opacity: material.opacity, side: material.side,
    depthWrite: material.depthWrite, vertexColors: true,
});

/** The parts of the scene that have no vertex of the object's: a floor that `precompute` added. */
function restOf(positions, triangles, isTaken) {
    const group = Int32Array.from({ length: positions.length / 3 }, (_, i) => i);
    const root = (vertex) => {
        while (group[vertex] !== vertex)
            vertex = group[vertex] = group[group[vertex]];
        return vertex;
    };
    for (let i = 0; i < triangles.length; ++i)
        group[root(triangles[i])] = root(triangles[i - i % 3]);
    const isObjects = new Uint8Array(group.length);
    isTaken.forEach((taken, vertex) => { isObjects[root(vertex)] |= taken; });
    return triangles.filter((vertex) => !isObjects[root(vertex)]);
}

export class LitObject {
    #scene;
    #parts = [];
    #radiance;

    static async of(object, scene) {
        if (scene.info.kind !== 'vertices')
            throw new RelumineError('WRONG_ARGUMENT', `expected a scene of vertices, got one of ${scene.info.kind}`);
        const lit = new LitObject();
        const [positions, normals, triangles] = [await scene.positions(), await scene.normals(), await scene.triangles()];
        const isTaken = new Uint8Array(positions.length / 3);
        lit.#scene = scene;
        for (const { mesh, geometry, receivers } of receiversOf(object, positions, normals)) {
            receivers.forEach((receiver) => { isTaken[receiver] = 1; });
            lit.#show(mesh, geometry, receivers);
        }
        const rest = restOf(positions, triangles, isTaken);
        if (rest.length > 0) {
            const geometry = new BufferGeometry();
            geometry.setAttribute('position', new BufferAttribute(positions, 3));
            geometry.setAttribute('normal', new BufferAttribute(normals, 3));
            geometry.setIndex(new BufferAttribute(rest, 1));
            lit.rest = new Mesh(geometry, new MeshBasicMaterial({ name: 'rest', color: 0xbcbcbc }));
            lit.#show(lit.rest, geometry, Int32Array.from({ length: isTaken.length }, (_, i) => i));
        }
        return lit;
    }

    /** Gives the mesh colours of its own, since others may have the same geometry. */
    #show(mesh, geometry, receivers) {
        const own = geometry.clone();
        const base = geometry.getAttribute('color');
        const size = base?.itemSize ?? 3;
        const colors = new BufferAttribute(new Float32Array(size * receivers.length), size);
        own.setAttribute('color', colors);
        mesh.geometry = own;
        mesh.material = Array.isArray(mesh.material) ? mesh.material.map(shown) : shown(mesh.material);
        this.#parts.push({ receivers, base, colors });
    }

    async update() {
        this.#radiance = await this.#scene.radiance(this.#radiance);
        for (const { receivers, base, colors } of this.#parts) {
            receivers.forEach((receiver, vertex) => {
                if (receiver < 0)
                    return;
                const [r, g, b] = this.#radiance.subarray(3 * receiver, 3 * receiver + 3);
                colors.setXYZ(vertex, r * (base?.getX(vertex) ?? 1), g * (base?.getY(vertex) ?? 1), b * (base?.getZ(vertex) ?? 1));
                if (colors.itemSize === 4)
                    colors.setW(vertex, base.getW(vertex));
            });
            colors.needsUpdate = true;
        }
    }
}
