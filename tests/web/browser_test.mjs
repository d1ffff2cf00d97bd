// A worker in a browser gives what this process gives, bit by bit:
//     node browser_test.mjs PACKAGE SCENE BROWSER
import assert from 'node:assert/strict';
import path from 'node:path';
import {test} from 'node:test';
import {fileURLToPath, pathToFileURL} from 'node:url';

import {inBrowser} from './browser.mjs';
import {steps} from './steps.js';

const [folder, scene, browser] = process.argv.slice(2);
const beside = (name) => fileURLToPath(new URL(name, import.meta.url));

test('radiance in a browser is that in node', {timeout: 120000}, async () => {
    const files = {'/page.html': beside('browser_test.html'), '/steps.js': beside('steps.js'), '/scene': scene};
    const bytes = await inBrowser(browser, files, folder);
    const {RelighterWorker} = await import(pathToFileURL(path.resolve(folder, 'relumine.js')));
    const expected = await steps(RelighterWorker, pathToFileURL(path.resolve(scene)));
    assert.ok(expected.some((value) => value > 0.1));
    // What went wrong is shorter.
    assert.equal(bytes.length, 4 * expected.length, bytes.toString().slice(0, 1000));
    assert.deepEqual(new Float32Array(Uint8Array.from(bytes).buffer), expected);
});
