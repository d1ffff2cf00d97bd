// When pictures are drawn and how finely: a machine that is slow, such as one without a GPU, gets fewer pixels while
// something moves, and all of them when it rests.
//
// A picture is not begun before the last one is there. On a slow machine the worker that finds the light takes turns with
// the drawing: both at the same time would slow each other down, for light that no picture shows.

/** Of the edges of the picture. */
const scales = [1, 0.7, 0.5, 0.35];
/** Milliseconds of a picture: above, the next one has fewer pixels; below, more. A step is a factor of two. */
const slow = 28, fast = 9;
/** Milliseconds that the worker waits at most: pages that are not seen draw nothing. */
const longestTurn = 1000;
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
    /** Calls for when a picture is there. */
    #waiting = [];

    /** Resolves when the first picture is there. */
    first = new Promise((resolve) => { this.isFirstThere = resolve; });

    /** `on`: {draw(), async drawn(): resolves when it is there, rescaled(): before a picture of another `scale`}. */
    constructor(on) { this.#on = on; }

    get scale() { return this.#isFull ? 1 : scales[this.#level]; }

    /** Whether a picture of something new is not there yet. */
    get isBusy() { return this.#isWanted || (this.#isDrawing && !this.#isFull); }

    /** Whether the picture is there in full. */
    get isAtRest() {
        return !this.#isDrawing && !this.#isWanted && this.#frame === undefined && this.#timer === undefined;
    }

    /** Resolves when the worker may find new light: at once, or on a slow machine when the last light is seen. */
    async turn() {
        const until = performance.now() + longestTurn;
        while (this.#level >= 2 && (this.#isDrawing || this.#isWanted) && performance.now() < until)
            await new Promise((resolve) => {
                this.#waiting.push(resolve);
                setTimeout(resolve, longestTurn);
            });
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
        this.#waiting.splice(0).forEach((resolve) => resolve());
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
