// Relighting in JavaScript: a scene that `relumine precompute` made, lit by any environment. relumine.d.ts says what
// each function takes and returns.
import { RelumineError, Runtime, bytesOf } from './wasm_module.js';

export { RelumineError } from './wasm_module.js';
export { RelighterWorker } from './relighter_worker.js';

const kinds = ['vertices', 'pixels', 'texels', 'points'];

function fail(message) {
    throw new RelumineError('WRONG_ARGUMENT', message);
}

/** Arrays of whole numbers hold bytes, or halves as three.js' loaders give them, and are no radiance. */
function requireNumbers(values, count, name) {
    if (!Array.isArray(values) && (!ArrayBuffer.isView(values) || values instanceof DataView))
        fail(`${name}: expected an array of numbers, got ${values}`);
    if (!Array.isArray(values) && !(values instanceof Float32Array) && !(values instanceof Float64Array))
        fail(`${name}: expected floats, got a ${values.constructor.name}`);
    if (values.length !== count)
        fail(`${name}: expected ${count} numbers, got ${values.length}`);
}

const isSize = (value) => Number.isInteger(value) && value >= 0 && value < 2 ** 31;

function requireSize(value, name) {
    if (!isSize(value))
        fail(`${name}: expected a whole number from 0, got ${value}`);
}

export class Relighter {
    #loaded;
    #scene = 0;

    get #runtime() {
        return this.#loaded ?? fail('expected a scene, got one after dispose()');
    }

    static async open(source, {wasm, harmonics = 0} = {}) {
        requireSize(harmonics, 'harmonics');
        const relighter = new Relighter();
        const bytes = await bytesOf(source);
        relighter.#loaded = await Runtime.make(wasm);
        try {
            relighter.#open(bytes, harmonics);
        } catch (error) {
            // The runtime read memory, and knows no path.
            if (error instanceof RelumineError && typeof (source?.href ?? source) === 'string')
                error.message = error.message.replace(/^memory:/, () => `${source}:`);
            throw error;
        }
        return relighter;
    }

    #open(bytes, harmonics) {
        const runtime = this.#runtime;
        runtime.withNumbers(Uint32Array, [12, 0, harmonics, 0], (options) =>
            runtime.withNumbers(Uint8Array, bytes, (at, count) => {
                // The last of the options' words is for the answer.
                runtime.call('open_bytes', at, count, options, options + 12);
                this.#scene = runtime.view().getUint32(options + 12, true);
            }));
        this.info = this.#askInfo();
    }

    #askInfo() {
        const names = ['kind', 'numReceivers', 'numClusters', 'numVertices', 'numTriangles', 'numHarmonics', 'hasBounces',
                       'width', 'height'];
        const size = 4 * (names.length + 3);
        return this.#runtime.with(size, (at) => {
            this.#runtime.view().setUint32(at, size, true);
            this.#call('info', at);
            const view = this.#runtime.view();
            const info = {};
            names.forEach((name, i) => { info[name] = view.getUint32(at + 4 * (i + 1), true); });
            info.kind = kinds[info.kind];
            info.hasBounces = info.hasBounces === 1;
            info.tolerance = view.getFloat32(at + size - 8, true);
            return Object.freeze(info);
        });
    }

    #call(name, ...given) {
        this.#runtime.call(name, this.#scene, ...given);
    }

    /** Fills the caller's array, or a new one, by the function of this name. */
    #filled(name, Type, count, into, ...given) {
        const result = into ?? new Type(count);
        if (!(result instanceof Type) || result.length !== count)
            fail(`expected a ${Type.name} of ${count} numbers to fill, got ${result?.constructor?.name} of ${result?.length}`);
        this.#runtime.with(Type.BYTES_PER_ELEMENT * count, (at) => {
            this.#call(name, ...given, at, count);
            result.set(this.#runtime.array(Type, at, count));
        });
        return result;
    }

    get #numValues() { return 3 * this.info.numReceivers; }

    /** Of the cube map that lights the scene; 0 where none does. */
    get resolution() {
        const size = 48;
        return this.#runtime.with(size, (at) => {
            this.#runtime.view().setUint32(at, size, true);
            this.#call('info', at);
            return this.#runtime.view().getUint32(at + size - 4, true);
        });
    }

    positions(into) { return this.#filled('positions', Float32Array, this.#numValues, into); }
    normals(into) { return this.#filled('normals', Float32Array, this.#numValues, into); }
    triangles(into) { return this.#filled('triangles', Uint32Array, 3 * this.info.numTriangles, into); }
    places(into) { return this.#filled('places', Uint32Array, this.info.numReceivers, into); }

    light(given) {
        const kind = ['cubeMap', 'latLong', 'lights'].filter((name) => given?.[name] !== undefined);
        if (kind.length !== 1)
            fail('expected one of cubeMap, latLong and lights');
        if (kind[0] === 'cubeMap')
            this.#lightCubeMap(given.cubeMap, given.resolution);
        else if (kind[0] === 'latLong')
            this.#lightLatLong(given.latLong, given.width, given.height, given.resolution ?? 0);
        else
            this.#lightList(given.lights);
    }

    #lightCubeMap(texels, resolution = Math.sqrt((texels.length ?? 0) / 18)) {
        if (!isSize(resolution))
            fail('cubeMap: expected [6][resolution][resolution][3] numbers');
        requireNumbers(texels, 18 * resolution * resolution, 'cubeMap');
        this.#runtime.withNumbers(Float32Array, texels, (at) => this.#call('light_cube_map', resolution, at));
    }

    #lightLatLong(pixels, width, height, resolution) {
        requireSize(width, 'width');
        requireSize(height, 'height');
        requireSize(resolution, 'resolution');
        if (width !== 2 * height)
            fail(`latLong: expected a width of twice the height, got ${width} x ${height}`);
        requireNumbers(pixels, 3 * width * height, 'latLong');
        this.#runtime.withNumbers(Float32Array, pixels,
                                  (at) => this.#call('light_lat_long', width, height, resolution, at));
    }

    #lightList(lights) {
        if (!Array.isArray(lights))
            fail(`lights: expected a list, got ${lights}`);
        const numbers = lights.flatMap(({direction, irradiance}) => {
            requireNumbers(direction, 3, 'direction');
            requireNumbers(irradiance, 3, 'irradiance');
            return [...direction, ...irradiance];
        });
        this.#runtime.withNumbers(Float32Array, numbers, (at) => this.#call('light_list', at, lights.length));
    }

    update(face, x, y, width, height, rgb) {
        for (const [name, value] of Object.entries({face, x, y, width, height}))
            requireSize(value, name);
        requireNumbers(rgb, 3 * width * height, 'rgb');
        this.#runtime.withNumbers(Float32Array, rgb, (at) => this.#call('update', face, x, y, width, height, at));
    }

    turn(degrees, {resolution} = {}) {
        if (resolution === undefined) {
            this.#call('turn', degrees);
            return;
        }
        requireSize(resolution, 'resolution');
        this.#call('turn_coarse', degrees, resolution);
    }

    setAlbedo(rgb) {
        requireNumbers(rgb, this.#numValues, 'albedo');
        this.#runtime.withNumbers(Float32Array, rgb, (at, count) => this.#call('set_albedo', at, count));
    }

    bounce({numBounces = 0, tolerance = 0, step = false} = {}) {
        requireSize(numBounces, 'numBounces');
        const size = 16;
        this.#runtime.with(size, (at) => {
            const view = this.#runtime.view();
            view.setUint32(at, size, true);
            view.setUint32(at + 4, numBounces, true);
            view.setFloat32(at + 8, tolerance, true);
            view.setUint32(at + 12, step ? 1 : 0, true);
            this.#call('bounce', at);
        });
    }

    radiance(into) { return this.#filled('radiance', Float32Array, this.#numValues, into); }
    radianceHalf(into) { return this.#filled('radiance_half', Uint16Array, this.#numValues, into); }
    harmonics(into) {
        return this.#filled('harmonics', Float32Array, this.#numValues * this.info.numHarmonics, into);
    }

    environment(into) { return this.#filled('environment', Float32Array, 18 * this.resolution ** 2, into); }
    contribution(receiver, into) {
        requireSize(receiver, 'receiver');
        return this.#filled('contribution', Float32Array, 18 * this.resolution ** 2, into, receiver);
    }

    visibleParts(directions, radius, {numReceivers = this.info.numReceivers} = {}) {
        const count = Math.floor((directions?.length ?? 0) / 3);
        requireNumbers(directions, 3 * count, 'directions');
        requireSize(numReceivers, 'numReceivers');
        return this.#runtime.withNumbers(Float32Array, directions, (at) =>
            this.#filled('visible_parts', Uint8Array, count * numReceivers, undefined, at, count, Number(radius)));
    }

    dispose() {
        this.#loaded?.functions.relumine_close(this.#scene);
        this.#loaded = undefined;
    }
}
