// Undo: a list of states, each a plain value.

export class History {
    #states = [];
    #at = -1;

    /** Keeps a state, unless it is the present one. What was undone is forgotten. */
    keep(state) {
        const text = JSON.stringify(state);
        if (text === this.#states[this.#at])
            return;
        this.#states.length = this.#at + 1;
        this.#states.push(text);
        if (this.#states.length > 200)
            this.#states.shift();
        this.#at = this.#states.length - 1;
    }

    get canUndo() { return this.#at > 0; }
    get canRedo() { return this.#at + 1 < this.#states.length; }
    undo() { return this.canUndo ? JSON.parse(this.#states[--this.#at]) : undefined; }
    redo() { return this.canRedo ? JSON.parse(this.#states[++this.#at]) : undefined; }
}
