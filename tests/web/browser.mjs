// Opens a page in a browser without a window.
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm'};

/** Serves files by their paths, the first of which is the page, and the package's folder as /package/. Resolves with the
 *  bytes that the page posts to /report. */
export function inBrowser(browser, files, folder) {
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'relumine-browser-'));
    return new Promise((resolve, reject) => {
        let child;
        const finish = (work) => {
            server.close();
            server.closeAllConnections();
            child.on('exit', () => {
                fs.rmSync(profile, {recursive: true, force: true, maxRetries: 5});
                work();
            });
            child.kill();
        };
        const server = http.createServer((request, response) => {
            if (request.url === '/report') {
                const parts = [];
                request.on('data', (part) => parts.push(part));
                request.on('end', () => {
                    response.end();
                    finish(() => resolve(Buffer.concat(parts)));
                });
                return;
            }
            const file = files[request.url] ??
                         (request.url.startsWith('/package/') ? path.join(folder, path.basename(request.url)) : '');
            if (!fs.existsSync(file)) {
                response.writeHead(404).end();
                return;
            }
            response.writeHead(200, {'Content-Type': types[path.extname(file)] ?? 'application/octet-stream'});
            fs.createReadStream(file).pipe(response);
        });
        server.listen(0, '127.0.0.1', () => {
            const url = `http://127.0.0.1:${server.address().port}${Object.keys(files)[0]}`;
            child = spawn(browser, ['--headless=new', '--no-sandbox', '--disable-gpu', `--user-data-dir=${profile}`, url],
                          {stdio: 'ignore'});
            child.on('error', reject);
        });
    });
}
