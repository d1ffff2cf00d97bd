// A Relighter in a worker: the page moves on while it works.
import {RelumineError, bytesOf} from './wasm_module.js';

const filled = ['positions', 'normals', 'triangles', 'places', 'radiance', 'radianceHalf', 'harmonics', 'environment',
                'contribution'];
const others = ['light', 'update', 'turn', 'setAlbedo', 'bounce', 'resolution'];

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

export class RelighterWorker {
    #worker;
    #waiting = new Map();
    #nextId = 0;

    static async open(source, {worker, wasm, ...options} = {}) {
        const own = new RelighterWorker();
        own.#listen(worker ?? await newWorker());
        try {
            own.info = await own.#call('open', [await sendable(source), {...options, wasm: await sendable(wasm)}]);
        } catch (error) {
            own.dispose();
            throw error;
        }
        return own;
    }

    #listen(worker) {
        this.#worker = worker;
        const onMessage = ({id, result, error}) => {
            const waiting = this.#waiting.get(id);
            this.#waiting.delete(id);
            if (error)
                waiting?.reject(new RelumineError(error.code, error.message));
            else
                waiting?.resolve(result);
        };
        const onError = (error) => this.#failAll(new RelumineError('FAILED', `worker.js: ${error.message ?? 'cannot be loaded'}`));
        if (worker.addEventListener) {
            worker.addEventListener('message', ({data}) => onMessage(data));
            worker.addEventListener('error', onError);
        } else {
            worker.on('message', onMessage);
            worker.on('error', onError);
        }
    }

    #failAll(error) {
        for (const {reject} of this.#waiting.values())
            reject(error);
        this.#waiting.clear();
    }

    #call(name, given, transferred = []) {
        if (!this.#worker)
            return Promise.reject(new RelumineError('WRONG_ARGUMENT', 'expected a scene, got one after dispose()'));
        return new Promise((resolve, reject) => {
            const id = this.#nextId++;
            this.#worker.postMessage({id, name, given}, transferred);
            this.#waiting.set(id, {resolve, reject});
        });
    }

    dispose() {
        this.#worker?.terminate();
        this.#worker = undefined;
        this.#failAll(new RelumineError('FAILED', 'expected a scene, got one after dispose()'));
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
