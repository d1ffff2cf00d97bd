// Axes are right-handed with +Y up. Colours are linear red, green, blue. docs/web.md tells more.

/** A file: its URL, a response that has it, or its bytes; in node also its path. */
export type Source = string | URL | Response | ArrayBuffer | ArrayBufferView;
export type Numbers = Float32Array | number[];

export type ErrorCode = 'WRONG_ARGUMENT' | 'WRONG_FILE' | 'OUT_OF_MEMORY' | 'NOT_LIT' | 'NOT_THERE' | 'FAILED';

/** The message is one sentence that says what was expected. Nothing has changed then. */
export class RelumineError extends Error {
    readonly code: ErrorCode;
    constructor(code: ErrorCode, message: string);
}

export interface OpenOptions {
    /** 2 or 3: keep the arriving light as spherical harmonics of this order, too. */
    harmonics?: 0 | 2 | 3;
    /** relumine.wasm, if it is not beside relumine.js. */
    wasm?: Source | WebAssembly.Module;
}

export interface Info {
    readonly kind: 'vertices' | 'pixels' | 'texels' | 'points';
    readonly numReceivers: number;
    readonly numClusters: number;
    readonly numVertices: number;
    readonly numTriangles: number;
    /** Coefficients of a receiver and channel: 0, 4 or 9. */
    readonly numHarmonics: number;
    /** bounce() works. */
    readonly hasBounces: boolean;
    /** Of a picture or a lightmap; 0 otherwise. */
    readonly width: number;
    readonly height: number;
    /** Of the precompute, 1/sr. */
    readonly tolerance: number;
}

/** [6][resolution][resolution][3], faces +X -X +Y -Y +Z -Z, rows from the top, as OpenGL's but seen from inside. */
export interface CubeMapLight {
    cubeMap: Numbers;
    resolution?: number;
}
/** [height][width][3], the top row is +Y. It becomes a cube map of `resolution`; 0: as fine as the picture. */
export interface LatLongLight {
    latLong: Numbers;
    width: number;
    height: number;
    resolution?: number;
}
/** Distant lights: the unit direction to each, and its irradiance on a surface that faces it. */
export interface LightList {
    lights: { direction: Numbers; irradiance: Numbers }[];
}
export type Light = CubeMapLight | LatLongLight | LightList;

export interface Turn {
    /** Turns a coarser copy of the map, halved until an edge has at most so many texels: for light that turns while it is
     *  looked at. Its texels are those that update() changes. */
    resolution?: number;
}

export interface Bounces {
    /** Exactly so many; 0: as many as `tolerance` asks for. */
    numBounces?: number;
    /** Relative error of all bounces; 0: 0.001. */
    tolerance?: number;
    /** One step on from the bounces before, for light that changes at every frame. */
    step?: boolean;
}

/** A scene and its light. Arrays that come back are copies; `into` is filled and returned in place of a new one. */
export class Relighter {
    private constructor();
    /** Opens a file of `relumine precompute` or `relumine export runtime`. */
    static open(source: Source, options?: OpenOptions): Promise<Relighter>;

    readonly info: Info;
    /** Of the cube map that lights the scene; 0 where none does. */
    readonly resolution: number;

    /** [numReceivers][3]. Receivers of `vertices` are the mesh's vertices, in the file's order. */
    positions(into?: Float32Array): Float32Array;
    normals(into?: Float32Array): Float32Array;
    /** [numTriangles][3] vertices. */
    triangles(into?: Uint32Array): Uint32Array;
    /** [numReceivers] the sample or texel of each, row by row from the top. Not for `vertices`. */
    places(into?: Uint32Array): Uint32Array;

    light(light: Light): void;
    /** New radiance for texels [x, x + width) x [y, y + height) of a face of the lit (and turned) cube map. */
    update(face: number, x: number, y: number, width: number, height: number, rgb: Numbers): void;
    /** Turns the environment about +Y, from how it stood before its first turn: light from +Z comes from +X at 90. */
    turn(degrees: number, how?: Turn): void;

    /** [numReceivers][3] the reflectance with which light bounces. Files of `export runtime` have it. */
    setAlbedo(rgb: Numbers): void;
    /** Adds the light that surfaces send to each other. New light has none until the next call. */
    bounce(how?: Bounces): void;

    /** [numReceivers][3] outgoing radiance for albedo 1: multiply it with the base colour. */
    radiance(into?: Float32Array): Float32Array;
    /** The same as bits of half floats. */
    radianceHalf(into?: Uint16Array): Uint16Array;
    /** [numReceivers][numHarmonics][3] the arriving light, bounces left out (docs/harmonics.md). */
    harmonics(into?: Float32Array): Float32Array;

    /** The cube map that lights the scene, turned and updated. */
    environment(into?: Float32Array): Float32Array;
    /** What lights a receiver: the cube map, each texel times the part of its light that arrives there. The sum of all
     *  texels times their solid angles is the receiver's radiance. */
    contribution(receiver: number, into?: Float32Array): Float32Array;

    /** How much of the sky each receiver sees around directions [n][3]: parts of 255, [receiver][direction]. A part is
     *  the mean of a cone of `radius` radians, weighted by the cosine to the normal. It darkens highlights that are
     *  found without shadows, such as those of a prefiltered environment. Needs no light.
     *  numReceivers: only the first ones, such as a scene's without its floor. */
    visibleParts(directions: Numbers, radius: number, options?: { numReceivers?: number }): Uint8Array;

    /** Gives the memory back. Nothing else works afterwards. */
    dispose(): void;
}

type Later<Work> = Work extends (...given: infer Given) => infer Result ? (...given: Given) => Promise<Result> : never;
type Worked = Omit<Relighter, 'info' | 'resolution' | 'dispose'>;

/** The same in a worker: each function returns a promise, and calls are carried out in the order in which they were
 *  made. Arrays that are given are copied; an `into` is handed over and comes back filled. */
export class RelighterWorker implements RelighterWorkerCalls {
    private constructor();
    /** `worker`: one that runs worker.js, in place of a new one. */
    static open(source: Source, options?: OpenOptions & { worker?: Worker }): Promise<RelighterWorker>;
    readonly info: Info;
    resolution(): Promise<number>;
    /** Ends the worker. Calls that are not done yet fail. */
    dispose(): void;
}
type RelighterWorkerCalls = { [Name in keyof Worked]: Later<Worked[Name]> };
export interface RelighterWorker extends RelighterWorkerCalls {}
