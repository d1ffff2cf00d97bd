// The other side of relighter_worker.js: carries out calls on a Relighter.
import {Relighter} from './relumine.js';
import {answerCalls} from './worker_calls.js';

const isBrowser = typeof WorkerGlobalScope !== 'undefined';
let relighter;

answerCalls(isBrowser ? globalThis : (await import('node:worker_threads')).parentPort, async (name, given) => {
    if (name === 'open') {
        relighter = await Relighter.open(...given);
        return relighter.info;
    }
    return name === 'resolution' ? relighter.resolution : relighter[name](...given);
});
