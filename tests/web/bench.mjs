// Times a scene in one worker:
//     node tests/web/bench.mjs PACKAGE SCENE [BROWSER]
// PACKAGE: the folder of relumine.js; SCENE: a file of `export runtime`; BROWSER: chromium, in place of node itself.
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const [folder, scene, browser] = process.argv.slice(2);
const here = import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname);

/** Serves the page, and resolves with what it reports. */
function inBrowser() {
    const files = {'/': path.join(here, 'bench.html'), '/measure.js': path.join(here, 'measure.js'), '/scene': scene};
    const types = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm'};
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'relumine-bench-'));
    return new Promise((resolve, reject) => {
        let child;
        const finish = (work) => {
            child.kill();
            server.close();
            child.on('exit', () => fs.rmSync(profile, {recursive: true, force: true, maxRetries: 3}));
            work();
        };
        const server = http.createServer((request, response) => {
            if (request.url === '/report') {
                let body = '';
                request.on('data', (part) => { body += part; });
                request.on('end', () => { response.end(); finish(() => resolve(JSON.parse(body))); });
                return;
            }
            const file = files[request.url] ?? path.join(folder, path.basename(request.url));
            if (!fs.existsSync(file)) {
                response.writeHead(404).end();
                return;
            }
            response.writeHead(200, {'Content-Type': types[path.extname(file)] ?? 'application/octet-stream'});
            fs.createReadStream(file).pipe(response);
        });
        server.listen(0, '127.0.0.1', () => {
            child = spawn(browser, ['--headless=new', '--no-sandbox', '--disable-gpu', `--user-data-dir=${profile}`,
                                    `http://127.0.0.1:${server.address().port}/`], {stdio: 'ignore'});
            child.on('error', reject);
        });
    });
}

async function inNode() {
    const {RelighterWorker} = await import(pathToFileURL(path.resolve(folder, 'relumine.js')));
    const {measure} = await import('./measure.js');
    return measure(RelighterWorker, pathToFileURL(path.resolve(scene)));
}

const {error, numReceivers, numClusters, tolerance, rows} = await (browser ? inBrowser() : inNode());
if (error) {
    console.error(error);
    process.exit(1);
}
console.log(`${path.basename(scene)}: ${numReceivers} receivers, ${numClusters} clusters, tolerance ${tolerance.toPrecision(3)}, ` +
            `${browser ?? `node ${process.version}`}, load ${os.loadavg()[0].toFixed(1)}`);
for (const [name, {times, least, median, p99}] of Object.entries(rows))
    console.log(`${name.padEnd(22)} ${String(times).padStart(4)} times: least ${least.toFixed(1)}, median ${median.toFixed(1)}, p99 ${p99.toFixed(1)} ms`);
