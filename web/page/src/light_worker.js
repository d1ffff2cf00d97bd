// The runtime in a worker: the light of the scene, from the state that the page sends.
//
// Light adds up, so the environment and the lights over it are lit each by itself: a light that is dragged costs what
// its texels cost, and a turn costs nothing of the lights. While something is dragged, bounces stay those of before;
// the last state of a drag gets all of them.
import {Relighter} from '../../package/relumine.js';
import {answerCalls} from '../../package/worker_calls.js';
import {CubeLights} from './cube_lights.js';
import {TurnedEnvironment} from './turned_environment.js';

const lightsResolution = 128;

let wasm, scene;
/** Each is {relighter, bounced}: what surfaces add to the light, of the last state that was no step. */
let base, extra;
let environment, drawing;
let now = {turn: undefined, lights: [], bounces: false, isStep: false};
/** Each is {direct, bounced}: radiance of a lamp of gain 1; `bounced` is there if the scene has bounces. */
let lampLights = [];

async function opened() {
    return {relighter: await Relighter.open(scene, {wasm}), bounced: undefined};
}

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

async function setLights(lights) {
    if (extra === undefined) {
        if (lights.length === 0)
            return;
        extra = await opened();
        drawing = new CubeLights(lightsResolution);
        extra.relighter.light({cubeMap: new Float32Array(18 * lightsResolution ** 2)});
        warmUp(lights[0]);
    }
    update(lights);
}

function update(lights) {
    for (const {face, x, y, width, height, rgb} of drawing.draw(lights))
        extra.relighter.update(face, x, y, width, height, rgb);
}

/**
 * Drags a light around once, before anybody drags one: the first steps take five times as long as later ones, until the
 * browser has compiled what they run for speed.
 */
function warmUp(light) {
    const steps = 12, seen = new Float32Array(3 * extra.relighter.info.numReceivers);
    for (let i = 0; i < steps; ++i) {
        const angle = 2 * Math.PI * i / steps;
        update([{...light, direction: [Math.sin(angle), 0.7, Math.cos(angle)]}]);
        extra.radiance = extra.relighter.radiance(extra.radiance);
        addTo(seen, extra.radiance);
    }
    update([]);
}

/** What the environment gives. Its runtime forgets bounces with each light, so those of before are kept here. */
function baseRadiance(bounces, isFinal, into) {
    const {relighter} = base;
    const direct = relighter.radiance(into);
    if (isFinal)
        base.bounced = undefined;
    if (!bounces)
        return direct;
    if (isFinal) {
        relighter.bounce();
        const all = relighter.radiance();
        base.bounced = direct;
        for (let i = 0; i < all.length; ++i)
            base.bounced[i] = all[i] - direct[i];
        return all;
    }
    if (base.bounced !== undefined)
        addTo(direct, base.bounced);
    return direct;
}

/** What the lights give. Their runtime keeps bounces when texels change. */
function extraRadiance(bounces, isFinal, into) {
    if (bounces && isFinal)
        extra.relighter.bounce();
    return extra.relighter.radiance(into);
}

function addTo(sum, part, factor = 1) {
    for (let i = 0; i < sum.length; ++i)
        sum[i] += factor * part[i];
}

const operations = {
    async open(given) {
        ({scene} = given);
        lampLights = given.lamps ?? [];
        wasm = await WebAssembly.compile(given.wasm).catch((error) => {
            throw new Error(`this browser needs WebAssembly with SIMD and exceptions for it (Chrome 95, Firefox 100, ` +
                            `Safari 16.4): ${error.message}`);
        });
        base = await opened();
        const {relighter} = base;
        const {kind, numReceivers, numTriangles, numClusters, hasBounces, tolerance} = relighter.info;
        const info = {kind, numReceivers, numTriangles, numClusters, hasBounces, tolerance};
        return {info, positions: relighter.positions(), normals: relighter.normals(), triangles: relighter.triangles()};
    },

    /** Takes a lat-long; the next state is lit by it. */
    environment({latLong, width, height, resolution}) {
        if (base !== undefined)
            base.bounced = undefined;
        environment = new TurnedEnvironment(latLong, width, height, resolution);
        now.turn = undefined;
        return {};
    },

    /** Brings the light to a state: {turn, lights, bounces, lamps}; `isStep`: it will go on changing. */
    async light({state, isStep, into}) {
        const start = performance.now();
        const bounces = state.bounces && base.relighter.info.hasBounces;
        const isTurned = state.turn !== now.turn, isDragged = !isSame(state.lights, now.lights);
        const isOther = bounces !== now.bounces;
        // What a step left unfinished is finished by what is no step.
        const isBaseNew = isTurned || isOther || (now.isTurnStep && !isStep);
        if (isBaseNew)
            base.relighter.light(isStep ? environment.quick(state.turn) : environment.exact(state.turn));
        if (isDragged)
            await setLights(state.lights);
        const count = 3 * base.relighter.info.numReceivers;
        const target = into?.length === count ? into : new Float32Array(count);
        // A light that is dragged leaves the environment's radiance as it was.
        if (isBaseNew || base.radiance === undefined)
            base.radiance = baseRadiance(bounces, !isStep, base.radiance);
        target.set(base.radiance);
        if (extra !== undefined && state.lights.length > 0) {
            const isExtraNew = isDragged || isOther || (now.isDragStep && !isStep);
            if (isExtraNew) {
                if (isOther)
                    extra.relighter.light({cubeMap: drawing.whole()});
                extra.radiance = extraRadiance(bounces, !isStep, extra.radiance);
            }
            addTo(target, extra.radiance);
        }
        state.lamps.forEach((gain, k) => {
            const {direct, bounced} = lampLights[k] ?? {};
            if (direct && gain !== 0)
                addTo(target, direct, gain);
            if (bounced && bounces && gain !== 0)
                addTo(target, bounced, gain);
        });
        now = {
            ...structuredClone(state), bounces, isTurnStep: isStep && (isTurned || now.isTurnStep === true),
            isDragStep: isStep && (isDragged || now.isDragStep === true),
        };
        return {radiance: target, milliseconds: performance.now() - start, isTurned, isDragged, isStep: isStep === true};
    },

    /** What receivers see of the sky around directions; and of all of it, as its light counts. */
    async seen({directions, radius, numReceivers}) {
        const parts = base.relighter.visibleParts(directions, radius, {numReceivers});
        base.relighter.light({cubeMap: new Float32Array(18).fill(1)});
        now.turn = undefined;
        return {parts, open: base.relighter.radiance().filter((_, i) => i % 3 === 0)};
    },

    /** Cube maps of what lights a receiver: by the environment, and by the lights. */
    contributions({receiver}) {
        const answer = {base: base.relighter.contribution(receiver)};
        if (extra !== undefined && now.lights.length > 0)
            answer.extra = extra.relighter.contribution(receiver);
        return answer;
    },
};

answerCalls(self, (operation, given) => operations[operation](given));
