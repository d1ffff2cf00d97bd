// The page's side of the worker.
import workerText from 'worker-text';
import {WorkerCalls} from '../../package/worker_calls.js';
import {PageError} from './assets.js';

export class LightClient {
    #calls;
    #isBusy = false;
    #wanted;
    #spare;

    /**
     * onRadiance({radiance, milliseconds, ...}) hears of each new light; onError of what went wrong. A step waits for
     * what turn() returns: light that nobody would see is not asked for.
     */
    constructor({onRadiance, onError, turn}) {
        this.turn = turn;
        this.onRadiance = onRadiance;
        this.onError = onError;
        const url = URL.createObjectURL(new Blob([workerText], {type: 'text/javascript'}));
        this.#calls = new WorkerCalls(new Worker(url), ({message}) => new PageError(message));
        URL.revokeObjectURL(url);
    }

    ask(operation, given, transferred = []) { return this.#calls.call(operation, given, transferred); }

    /** Asks for the light of a state. States that a newer one overtakes are left out. */
    want(state, isStep) {
        this.#wanted = {state: structuredClone(state), isStep};
        this.#work();
    }

    async #work() {
        if (this.#isBusy || this.#wanted === undefined)
            return;
        this.#isBusy = true;
        if (this.#wanted.isStep)
            await this.turn();
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

    end() { this.#calls.end('the page was closed'); }
}
