// Makes the page's parts: node build.mjs MODULES WASM OUT
// MODULES: the folder node_modules with three and esbuild; WASM: relumine.wasm; OUT: the folder to write.
import fs from 'node:fs';
import path from 'node:path';
import {createRequire} from 'node:module';
import {fileURLToPath} from 'node:url';
import zlib from 'node:zlib';

const [modules, wasm, out] = process.argv.slice(2).map((name) => path.resolve(name));
const here = path.dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(path.join(modules, 'x'))('esbuild');

const common = {
    bundle: true, minify: true, write: false, target: ['chrome95', 'firefox100', 'safari16.4'], nodePaths: [modules],
    legalComments: 'none', external: ['node:*'], loader: {'.css': 'text'}, logLevel: 'warning',
};
const build = async (options) => (await esbuild.build({...common, ...options})).outputFiles[0].text;

// The worker is text within the page's module, so that it also starts where files cannot load files.
const worker = await build({
    entryPoints: [path.join(here, 'src/light_worker.js')], format: 'iife',
    define: {'import.meta.url': '"https://relumine.invalid/"'},
});
const page = await build({
    entryPoints: [path.join(here, 'src/viewer.js')], format: 'esm',
    plugins: [{
        name: 'worker',
        setup(plugins) {
            plugins.onResolve({filter: /^worker-text$/}, () => ({path: 'worker', namespace: 'worker'}));
            plugins.onLoad({filter: /.*/, namespace: 'worker'}, () => ({contents: worker, loader: 'text'}));
        },
    }],
});

fs.mkdirSync(out, {recursive: true});
const write = (name, content) => fs.writeFileSync(path.join(out, name), content);
const three = path.join(modules, 'three');
const {version} = JSON.parse(fs.readFileSync(path.join(three, 'package.json'), 'utf8'));
// A third of the size: the script unpacks itself, whatever the server sends it as.
write('relumine-viewer.js', `/*! Relumine: Apache-2.0. three.js ${version}: MIT, see LICENSE-three.txt */
const packed = Uint8Array.from(atob('${zlib.gzipSync(page, {level: 9}).toString('base64')}'), (letter) => letter.charCodeAt(0));
const script = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
const url = URL.createObjectURL(new Blob([script], {type: 'text/javascript'}));
await import(url);
URL.revokeObjectURL(url);
`);
write('relumine.wasm.gz', zlib.gzipSync(fs.readFileSync(wasm), {level: 9}));
write('index.html', fs.readFileSync(path.join(here, 'index.html')));
const zstd = path.join(path.dirname(wasm), '../zstd/package/deps/zstd/LICENSE');
write('LICENSE-three.txt', `${fs.readFileSync(path.join(three, 'LICENSE'))}
relumine.wasm has zstd:

${fs.readFileSync(zstd)}`);
