// Times a scene in one worker:
//     node tests/web/bench.mjs PACKAGE SCENE [BROWSER]
// PACKAGE: the folder of relumine.js; SCENE: a file of `export runtime`; BROWSER: chromium, in place of node itself.
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

import {inBrowser} from './browser.mjs';

const [folder, scene, browser] = process.argv.slice(2);
const beside = (name) => fileURLToPath(new URL(name, import.meta.url));

async function inNode() {
    const {RelighterWorker} = await import(pathToFileURL(path.resolve(folder, 'relumine.js')));
    const {measure} = await import('./measure.js');
    return measure(RelighterWorker, pathToFileURL(path.resolve(scene)));
}

const files = {'/bench.html': beside('bench.html'), '/measure.js': beside('measure.js'), '/scene': scene};
const {error, numReceivers, numClusters, tolerance, rows} =
    browser ? JSON.parse(await inBrowser(browser, files, folder)) : await inNode();
if (error) {
    console.error(error);
    process.exit(1);
}
console.log(`${path.basename(scene)}: ${numReceivers} receivers, ${numClusters} clusters, tolerance ${tolerance.toPrecision(3)}, ` +
            `${browser ?? `node ${process.version}`}, load ${os.loadavg()[0].toFixed(1)}`);
for (const [name, {times, least, median, p99}] of Object.entries(rows))
    console.log(`${name.padEnd(22)} ${String(times).padStart(4)} times: least ${least.toFixed(1)}, ` +
                `median ${median.toFixed(1)}, p99 ${p99.toFixed(1)} ms`);
