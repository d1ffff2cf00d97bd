#!/usr/bin/env bash
# three-gpu-pathtracer: suns and lamps light rough plastics by three quarters.
#
# Expected: a directional light of intensity pi straight above a white surface of roughness 1, seen from above, shows
#           0.97: the highlight takes 0.04 and gives 0.01. Lights without size need no ray of the surface to be found.
# Found:    0.72 to 0.75. The shadow ray starts on the side of the surface to which the material's own sample went. Samples of a
#           wide highlight go below the surface, and from there the light is hidden. A dome loses no such part.
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

async function shown(roughness) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0);
  const material = new THREE.MeshPhysicalMaterial({ color: 0xffffff, roughness });
  scene.add(new THREE.Mesh(new THREE.PlaneGeometry(4, 4), material));
  const sun = new THREE.DirectionalLight(0xffffff, Math.PI);
  sun.position.set(0, 0, 10);
  scene.add(sun, sun.target);
  const camera = new THREE.PerspectiveCamera(10, 1, 0.1, 100);
  camera.position.set(0, 0, 5);
  return mean(scene, camera, 1);
}
window.found = (async () => [await shown(1)])();
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
[rough] = found
print(f"found: {rough:.3f}")
raise SystemExit(not 0.65 < rough < 0.8)
PYTHON
env/bin/python look.py
