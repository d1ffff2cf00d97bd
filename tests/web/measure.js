// What a page does with a scene in its light, timed: in a browser (bench.html) and in node (bench.mjs).

const resolution = 256;

/** A sky, brighter towards the top, with noise. */
function sky() {
    let state = 1;
    const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
    const map = new Float32Array(18 * resolution ** 2);
    for (let i = 0; i < map.length; i += 3) {
        const face = Math.floor(i / 3 / resolution ** 2), row = Math.floor(i / 3 / resolution) % resolution;
        const up = face === 2 ? 1 : face === 3 ? 0.1 : 1 - 0.9 * row / resolution;
        map.set([0.4 * up + 0.1 * next(), 0.6 * up + 0.1 * next(), up + 0.1 * next()], i);
    }
    return map;
}

/** A round light of 8 degrees radius that goes around on the upper face: the rectangle where it was and is. */
function drag(map, step) {
    const radius = 0.07 * resolution, face = 2;
    const at = (i) => [0.5 + 0.3 * Math.cos(0.1 * i), 0.5 + 0.3 * Math.sin(0.1 * i)].map((s) => s * resolution);
    const [before, now] = [at(step - 1), at(step)];
    const low = [0, 1].map((k) => Math.floor(Math.min(before[k], now[k]) - radius));
    const high = [0, 1].map((k) => Math.ceil(Math.max(before[k], now[k]) + radius));
    const width = high[0] - low[0], height = high[1] - low[1], rgb = new Float32Array(3 * width * height);
    for (let y = low[1], i = 0; y < high[1]; ++y)
        for (let x = low[0]; x < high[0]; ++x, i += 3) {
            const own = 3 * ((face * resolution + y) * resolution + x);
            const light = Math.hypot(x + 0.5 - now[0], y + 0.5 - now[1]) < radius ? 20 : 0;
            rgb.set([map[own] + light, map[own + 1] + light, map[own + 2] + light], i);
        }
    return [face, low[0], low[1], width, height, rgb];
}

async function timed(times, work) {
    const taken = [];
    for (let i = 0; i < times; ++i) {
        const begin = performance.now();
        await work(i);
        taken.push(performance.now() - begin);
    }
    taken.sort((a, b) => a - b);
    const part = (of) => taken[Math.min(times - 1, Math.floor(of * times))];
    return {times, least: taken[0], median: part(0.5), p99: part(0.99)};
}

/** Each row is the time from a call to the new radiance in the page's hands, milliseconds. */
export async function measure(RelighterWorker, source) {
    let relighter, radiance;
    const map = sky();
    const rows = {};
    const take = async () => { radiance = await relighter.radiance(radiance); };
    rows['open, and first light'] = await timed(1, async () => {
        relighter = await RelighterWorker.open(source);
        relighter.light({cubeMap: map});
        await take();
    });
    rows['all light'] = await timed(20, async () => { relighter.light({cubeMap: map}); await take(); });
    const steps = Array.from({length: 300}, (_, i) => drag(map, i));
    rows['drag of a light'] = await timed(steps.length, async (i) => { relighter.update(...steps[i]); await take(); });
    rows['turn, R = 128'] = await timed(60, async (i) => { relighter.turn(2 * i + 1, {resolution: 128}); await take(); });
    rows['turn, R = 256'] = await timed(20, async (i) => { relighter.turn(2 * i + 1); await take(); });
    if (relighter.info.hasBounces)
        rows['a step of bounces'] = await timed(20, async () => { relighter.bounce({step: true}); await take(); });
    const {numReceivers, numClusters, tolerance} = relighter.info;
    relighter.dispose();
    return {numReceivers, numClusters, tolerance, rows};
}
