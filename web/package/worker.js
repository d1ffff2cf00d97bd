// The other side of relighter_worker.js: carries out calls on a Relighter, one after the other.
import {Relighter} from './relumine.js';

const isBrowser = typeof WorkerGlobalScope !== 'undefined';
const port = isBrowser ? globalThis : (await import('node:worker_threads')).parentPort;
let relighter;

async function carryOut(name, given) {
    if (name === 'open') {
        relighter = await Relighter.open(...given);
        return relighter.info;
    }
    return name === 'resolution' ? relighter.resolution : relighter[name](...given);
}

// A call begins when the one before has ended.
let last = Promise.resolve();

function take({id, name, given}) {
    last = last.then(async () => {
        try {
            const result = await carryOut(name, given);
            port.postMessage({id, result}, ArrayBuffer.isView(result) ? [result.buffer] : []);
        } catch (error) {
            port.postMessage({id, error: {code: error.code ?? 'FAILED', message: error.message}});
        }
    });
}

if (isBrowser)
    port.addEventListener('message', ({data}) => take(data));
else
    port.on('message', take);
