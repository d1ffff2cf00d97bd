// The page's side of the worker.
import workerText from 'worker-text';
import {PageError} from './assets.js';

export class LightClient {
    #worker;
    #waiting = new Map();
    #next = 0;
    #isBusy = false;
    #wanted;
    #spare;

    /** onRadiance({radiance, milliseconds, ...}) hears of each new light; onError of what went wrong. */
    constructor({onRadiance, onError}) {
        this.onRadiance = onRadiance;
        this.onError = onError;
        const url = URL.createObjectURL(new Blob([workerText], {type: 'text/javascript'}));
        this.#worker = new Worker(url);
        URL.revokeObjectURL(url);
        this.#worker.onmessage = ({data: {id, answer, error}}) => {
            const {resolve, reject} = this.#waiting.get(id);
            this.#waiting.delete(id);
            if (error === undefined)
                resolve(answer);
            else
                reject(new PageError(error));
        };
        this.#worker.onerror = (event) => {
            event.preventDefault();
            this.onError(new PageError(`The light cannot be computed: ${event.message ?? 'the worker did not start'}.`));
        };
    }

    ask(operation, given, transferred = []) {
        return new Promise((resolve, reject) => {
            const id = this.#next++;
            this.#waiting.set(id, {resolve, reject});
            this.#worker.postMessage({id, operation, given}, transferred);
        });
    }

    /** Asks for the light of a state. States that a newer one overtakes are left out. */
    want(state, isStep) {
        this.#wanted = {state: structuredClone(state), isStep};
        this.#work();
    }

    async #work() {
        if (this.#isBusy || this.#wanted === undefined)
            return;
        this.#isBusy = true;
        const {state, isStep} = this.#wanted;
        this.#wanted = undefined;
        try {
            const into = this.#spare;
            this.#spare = undefined;
            this.onRadiance(await this.ask('light', {state, isStep, into}, into ? [into.buffer] : []));
        } catch (error) {
            this.onError(error);
        }
        this.#isBusy = false;
        this.#work();
    }

    /** Gives an array back that onRadiance() had. */
    recycle(array) { this.#spare = array; }

    /** Whether no light is asked for that is not there. */
    get isSettled() { return !this.#isBusy && this.#wanted === undefined; }

    end() { this.#worker.terminate(); }
}
