// Calls to a worker and their answers: {id, name, given} there, {id, result} or {id, error} back.

export class WorkerCalls {
    #worker;
    #waiting = new Map();
    #nextId = 0;
    #errorOf;

    /** `errorOf({code, message})` makes what a failed call is rejected with. */
    constructor(worker, errorOf) {
        this.#worker = worker;
        this.#errorOf = errorOf;
        const onMessage = ({id, result, error}) => {
            const waiting = this.#waiting.get(id);
            this.#waiting.delete(id);
            if (error)
                waiting?.reject(errorOf(error));
            else
                waiting?.resolve(result);
        };
        const onError = (event) => {
            event.preventDefault?.();
            this.#failAll(`the worker stopped: ${event.message ?? 'its script cannot be loaded'}`);
        };
        if (worker.addEventListener) {
            worker.addEventListener('message', ({data}) => onMessage(data));
            worker.addEventListener('error', onError);
        } else {
            worker.on('message', onMessage);
            worker.on('error', onError);
        }
    }

    #failAll(message) {
        for (const {reject} of this.#waiting.values())
            reject(this.#errorOf({code: 'FAILED', message}));
        this.#waiting.clear();
    }

    call(name, given, transferred = []) {
        return new Promise((resolve, reject) => {
            const id = this.#nextId++;
            this.#worker.postMessage({id, name, given}, transferred);
            this.#waiting.set(id, {resolve, reject});
        });
    }

    /** Calls that wait fail with the message. */
    end(message) {
        this.#worker.terminate();
        this.#failAll(message);
    }
}

/** Buffers of arrays in an answer: they move, and are not copied. */
function buffersOf(result) {
    const values = ArrayBuffer.isView(result) ? [result] : Object.values(result ?? {});
    return values.filter(ArrayBuffer.isView).map((array) => array.buffer);
}

/** In the worker: answers calls by carryOut(name, given), each when the one before has ended. */
export function answerCalls(port, carryOut) {
    let last = Promise.resolve();
    const take = ({id, name, given}) => {
        last = last.then(async () => {
            try {
                const result = await carryOut(name, given);
                port.postMessage({id, result}, buffersOf(result));
            } catch (error) {
                port.postMessage({id, error: {code: error.code ?? 'FAILED', message: error.message ?? String(error)}});
            }
        });
    };
    if (port.addEventListener)
        port.addEventListener('message', ({data}) => take(data));
    else
        port.on('message', take);
}
