// A Relighter in a worker: the page moves on while it works.
import {RelumineError, bytesOf} from './wasm_module.js';
import {WorkerCalls} from './worker_calls.js';

const filled = ['positions', 'normals', 'triangles', 'places', 'radiance', 'radianceHalf', 'harmonics', 'environment',
                'contribution'];
const others = ['light', 'update', 'turn', 'setAlbedo', 'bounce', 'resolution', 'visibleParts'];

async function newWorker() {
    const url = new URL('worker.js', import.meta.url);
    if (typeof Worker !== 'undefined')
        return new Worker(url, {type: 'module'});
    return new (await import('node:worker_threads')).Worker(url);
}

/** URLs mean in the worker what they mean here, and what cannot be sent is read here. */
async function sendable(source) {
    if (typeof source === 'string' && typeof location !== 'undefined')
        return new URL(source, location.href).href;
    if (source instanceof URL)
        return source.href;
    if (typeof Response !== 'undefined' && source instanceof Response)
        return bytesOf(source);
    return source;
}

const errorOf = ({code, message}) => new RelumineError(code, message);
const afterDispose = 'expected a scene, got one after dispose()';

export class RelighterWorker {
    #calls;

    static async open(source, {worker, wasm, ...options} = {}) {
        const own = new RelighterWorker();
        own.#calls = new WorkerCalls(worker ?? await newWorker(), errorOf);
        try {
            own.info = await own.#call('open', [await sendable(source), {...options, wasm: await sendable(wasm)}]);
        } catch (error) {
            own.dispose();
            throw error;
        }
        return own;
    }

    #call(name, given, transferred) {
        return this.#calls?.call(name, given, transferred) ??
            Promise.reject(new RelumineError('WRONG_ARGUMENT', afterDispose));
    }

    dispose() {
        this.#calls?.end(afterDispose);
        this.#calls = undefined;
    }

    static {
        for (const name of others)
            this.prototype[name] = function(...given) { return this.#call(name, given); };
        // The array to fill is handed over.
        for (const name of filled)
            this.prototype[name] = function(...given) {
                return this.#call(name, given, given.filter(ArrayBuffer.isView).map((array) => array.buffer));
            };
    }
}
