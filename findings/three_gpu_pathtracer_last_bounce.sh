#!/usr/bin/env bash
# three-gpu-pathtracer: the last surface of a path has a part of the sky's light.
#
# Expected: with `bounces` 1, a white ball under a white sky is lit by it and shows about 1, as rasterized three.js does.
# Found:    0.17. `bounces` are the rays of a path. The light of the environment is the sum of two weighted estimates, by
#           a ray to the map and by the next ray of the surface. At the last surface the second one is missing, and for
#           an even sky that is most of it. With 2 the ball has all its light. In a closed room each number of
#           bounces is darker than it says.
# Tried:    three-gpu-pathtracer 0.0.26 (its tracer by WebGL), three 0.187.0, of npm; Debian 12's chromium 156 and
#           chromium-driver, which must be there; selenium 4.38.0 of PyPI.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three-gpu-pathtracer@0.0.26 three@0.187.0 three-mesh-bvh@0.9.17
python3 -m venv env
env/bin/pip install -q selenium==4.38.0
cat >page.html <<'HTML'
<!doctype html>
<script type="importmap">{"imports": {
    "three": "./node_modules/three/build/three.module.js",
    "three/": "./node_modules/three/",
    "three-mesh-bvh": "./node_modules/three-mesh-bvh/src/index.js",
    "three-gpu-pathtracer": "./node_modules/three-gpu-pathtracer/build/index.module.js"
}}</script>
<script type="module">
import * as THREE from 'three';
import { WebGLPathTracer } from 'three-gpu-pathtracer';

const renderer = new THREE.WebGLRenderer();
const tracer = new WebGLPathTracer(renderer);
tracer.tiles.set(1, 1);
Object.assign(tracer, { renderDelay: 0, minSamples: 0, rasterizeScene: false, renderToCanvas: false });
renderer.setSize(8, 8);

// The mean of the picture's red.
async function mean(scene, camera, bounces) {
  tracer.bounces = bounces;
  tracer.setScene(scene, camera);
  do {
    tracer.renderSample();
    await new Promise((resolve) => setTimeout(resolve));
  } while (tracer.samples < 128);
  const pixels = new Float32Array(4 * 64);
  await renderer.readRenderTargetPixelsAsync(tracer.target, 0, 0, 8, 8, pixels);
  return pixels.filter((_, i) => i % 4 === 0).reduce((sum, each) => sum + each, 0) / 64;
}

const width = 32, sky = new THREE.DataTexture(new Float32Array(4 * width * width / 2).fill(1), width, width / 2, THREE.RGBAFormat, THREE.FloatType);
sky.mapping = THREE.EquirectangularReflectionMapping;
sky.minFilter = sky.magFilter = THREE.LinearFilter;
sky.needsUpdate = true;
const scene = new THREE.Scene();
scene.environment = scene.background = sky;
scene.add(new THREE.Mesh(new THREE.SphereGeometry(1, 64, 32), new THREE.MeshPhysicalMaterial({ color: 0xffffff, roughness: 1 })));
const camera = new THREE.PerspectiveCamera(15, 1, 0.1, 100);
camera.position.set(0, 0, 5);
window.found = (async () => [await mean(scene, camera, 1), await mean(scene, camera, 2)])();
</script>
HTML
cat >look.py <<'PYTHON'
import functools, http.server, shutil, threading
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

http.server.SimpleHTTPRequestHandler.log_message = lambda *_: None
server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), http.server.SimpleHTTPRequestHandler)
threading.Thread(target=server.serve_forever, daemon=True).start()
options = webdriver.ChromeOptions()
options.binary_location = shutil.which("chromium")
for argument in ("--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader"):
    options.add_argument(argument)
driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
driver.set_script_timeout(600)
driver.get(f"http://127.0.0.1:{server.server_port}/page.html")
found = driver.execute_async_script("const [done] = arguments, wait = () => (window.found ? window.found.then(done) : setTimeout(wait, 50)); wait();")
driver.quit()
one, two = found
print(f"found: bounces 1 {one:.3f}, bounces 2 {two:.3f}")
raise SystemExit(not (one < 0.4 and two > 0.9))
PYTHON
env/bin/python look.py
