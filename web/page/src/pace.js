// When pictures are drawn and how finely: a machine that is slow, such as one without a GPU, gets fewer pixels while
// something moves, and all of them when it rests.
//
// A picture is not begun before the last one is there. Otherwise drawing would take all of the machine, and the worker
// that finds the light would wait for it.

/** Of the edges of the picture. */
const scales = [1, 0.7, 0.5, 0.35];
/** Milliseconds of a picture: above, the next one has fewer pixels; below, more. A step is a factor of two. */
const slow = 28, fast = 9;
/** Milliseconds without a new picture after which all pixels are drawn. */
const rest = 200;

export class Pace {
    #on;
    /** The first picture has a quarter of the pixels: a slow machine shows something early. */
    #level = 2;
    #isFull = false;
    /** Of the last picture. */
    #shown = 0;
    #isDrawing = false;
    #isWanted = false;
    #frame;
    #timer;

    /** Resolves when the first picture is there. */
    first = new Promise((resolve) => { this.isFirstThere = resolve; });

    /** `on`: {draw(), async drawn(): resolves when it is there, rescaled(): before a picture of another `scale`}. */
    constructor(on) { this.#on = on; }

    get scale() { return this.#isFull ? 1 : scales[this.#level]; }

    /** Whether the picture is there in full. */
    get isAtRest() {
        return !this.#isDrawing && !this.#isWanted && this.#frame === undefined && this.#timer === undefined;
    }

    /** Something has changed. */
    ask() {
        this.#isWanted = true;
        clearTimeout(this.#timer);
        this.#timer = undefined;
        this.#schedule();
    }

    #schedule() {
        if (this.#isDrawing || this.#frame !== undefined)
            return;
        this.#frame = requestAnimationFrame(() => {
            this.#frame = undefined;
            this.#draw();
        });
    }

    /** What moves is drawn at the scale of the machine; where nothing has changed, in full. */
    async #draw() {
        this.#isFull = !this.#isWanted;
        this.#isWanted = false;
        this.#isDrawing = true;
        if (this.scale !== this.#shown)
            this.#on.rescaled();
        this.#shown = this.scale;
        const start = performance.now();
        this.#on.draw();
        await this.#on.drawn();
        this.#isDrawing = false;
        this.isFirstThere();
        this.#learn(performance.now() - start);
        if (this.#isWanted)
            this.#schedule();
        else if (this.#shown < 1)
            this.#timer = setTimeout(() => {
                this.#timer = undefined;
                this.#schedule();
            }, this.#level === 0 ? 0 : rest);
    }

    #learn(milliseconds) {
        if (this.#isFull && milliseconds < slow)
            this.#level = 0;
        else if (!this.#isFull && milliseconds > slow)
            this.#level = Math.min(this.#level + 1, scales.length - 1);
        else if (!this.#isFull && milliseconds < fast)
            this.#level = Math.max(this.#level - 1, 0);
    }

    end() {
        cancelAnimationFrame(this.#frame);
        clearTimeout(this.#timer);
    }
}
