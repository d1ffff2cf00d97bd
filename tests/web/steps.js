/** Light, an update, a turn and bounces in a worker: radiance after each. */
export async function steps(RelighterWorker, source) {
    const relighter = await RelighterWorker.open(source);
    const resolution = 128, map = new Float32Array(18 * resolution ** 2);
    for (let i = 0; i < map.length; ++i)
        map[i] = (i * 7919 % 1000) / 1000;
    const size = 20, lamp = new Float32Array(3 * size * size).fill(9);
    const after = [];
    relighter.light({cubeMap: map});
    after.push(relighter.radiance());
    relighter.update(2, 30, 40, size, size, lamp);
    after.push(relighter.radiance());
    relighter.turn(40);
    after.push(relighter.radiance());
    relighter.bounce();
    after.push(relighter.radiance());
    const parts = await Promise.all(after);
    relighter.dispose();
    const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
    parts.forEach((part, i) => all.set(part, i * part.length));
    return all;
}
