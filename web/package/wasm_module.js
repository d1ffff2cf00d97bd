// Loads relumine.wasm and calls its functions, which are those of relumine_runtime.h.

const needed = 'WebAssembly with SIMD and exceptions (Chrome 95, Firefox 100, Safari 16.4, node 18)';

/** What the runtime says is wrong; `code` is one of RelumineResult's names. */
export class RelumineError extends Error {
    constructor(code, message) {
        super(message);
        this.name = 'RelumineError';
        this.code = code;
    }
}

const codes = ['OK', 'WRONG_ARGUMENT', 'WRONG_FILE', 'OUT_OF_MEMORY', 'NOT_LIT', 'NOT_THERE', 'FAILED'];
const isNode = typeof process !== 'undefined' && process.versions?.node !== undefined;
/** A letter and a colon begin a path of Windows. */
const isFile = (source) => source instanceof URL ? source.protocol === 'file:' : !/^[a-z][a-z0-9+.-]+:/i.test(source);

/** Takes a URL (or its text), a Response, an ArrayBuffer or a view of one, in node also the path of a file; returns bytes. */
export async function bytesOf(source) {
    if (source instanceof ArrayBuffer)
        return new Uint8Array(source);
    if (ArrayBuffer.isView(source))
        return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
    if (typeof source === 'string' && source.startsWith('file:'))
        source = new URL(source);
    if (isNode && (typeof source === 'string' || source instanceof URL) && isFile(source))
        try {
            return new Uint8Array(await (await import('node:fs/promises')).readFile(source));
        } catch (error) {
            throw new RelumineError('WRONG_FILE', `${source}: cannot read: ${error.code}`);
        }
    if (typeof source === 'string' || source instanceof URL)
        source = await fetch(source);
    if (typeof Response === 'undefined' || !(source instanceof Response))
        throw new RelumineError('WRONG_ARGUMENT', `expected a URL, a Response or an ArrayBuffer, got ${source}`);
    if (!source.ok)
        throw new RelumineError('WRONG_FILE', `${source.url}: expected a file, got ${source.status} ${source.statusText}`);
    return new Uint8Array(await source.arrayBuffer());
}

async function compile(source) {
    if (typeof WebAssembly === 'undefined')
        throw new RelumineError('FAILED', `expected ${needed}`);
    if (source instanceof WebAssembly.Module)
        return source;
    const bytes = await bytesOf(source);
    try {
        return await WebAssembly.compile(bytes);
    } catch (error) {
        throw new RelumineError('FAILED', `relumine.wasm: expected ${needed}, got: ${error.message}`);
    }
}

const standard = new URL('relumine.wasm', import.meta.url);
let compiled;

/** Compiles once what stands beside this file. */
export function compiledModule(source) {
    if (source !== undefined)
        return compile(source);
    compiled ??= compile(standard).catch((error) => {
        compiled = undefined;
        throw error;
    });
    return compiled;
}

/** The runtime has no files, no environment variables and nothing to print on: it asks for a clock only. */
function imports(module, view) {
    const noSystemCall = 52;
    const known = {
        clock_time_get(_id, _precision, at) {
            view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
            return 0;
        },
        environ_sizes_get(count, size) {
            view().setUint32(count, 0, true);
            view().setUint32(size, 0, true);
            return 0;
        },
        environ_get: () => 0,
        emscripten_notify_memory_growth() {},
        proc_exit(code) {
            throw new RelumineError('FAILED', `relumine.wasm ended with ${code}`);
        },
    };
    const result = {};
    for (const {module: from, name} of WebAssembly.Module.imports(module)) {
        result[from] ??= {};
        result[from][name] = known[name] ?? (() => name.startsWith('__syscall') ? -noSystemCall : noSystemCall);
    }
    return result;
}

/** An instance of the module, with a memory of its own. */
export class Runtime {
    static async make(source) {
        const runtime = new Runtime();
        const module = await compiledModule(source);
        const instance = await WebAssembly.instantiate(module, imports(module, () => runtime.view()));
        runtime.functions = instance.exports;
        runtime.functions._initialize();
        return runtime;
    }

    // Views end when memory grows, so nobody keeps one.
    view() { return new DataView(this.functions.memory.buffer); }
    array(Type, at, count) { return new Type(this.functions.memory.buffer, at, count); }

    /** Calls a function that returns a RelumineResult. */
    call(name, ...given) {
        const result = this.functions[`relumine_${name}`](...given);
        if (result !== 0)
            throw new RelumineError(codes[result] ?? 'FAILED', this.text(this.functions.relumine_last_error()));
    }

    text(at) {
        const bytes = this.array(Uint8Array, at);
        return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
    }

    /** Calls use(address) with so many bytes of memory, which are free again afterwards. */
    with(numBytes, use) {
        const at = this.functions.malloc(Math.max(numBytes, 8));
        if (at === 0)
            throw new RelumineError('OUT_OF_MEMORY', `out of memory: ${numBytes} bytes`);
        try {
            return use(at >>> 0);
        } finally {
            this.functions.free(at);
        }
    }

    /** The same with an array's numbers. */
    withNumbers(Type, numbers, use) {
        return this.with(Type.BYTES_PER_ELEMENT * numbers.length, (at) => {
            this.array(Type, at, numbers.length).set(numbers);
            return use(at, numbers.length);
        });
    }
}
