// The page of index.html: drag turns the eye, the slider below turns the light.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { RelighterWorker } from 'relumine';
import { LitObject } from 'relumine/three';

const words = document.querySelector('p');
const asked = new URLSearchParams(location.search);
const folder = new URL(`${asked.get('scene') ?? '.'}/`, location.href);

/** What a promise brings; what fails is said on the page. */
async function told(promise) {
    try {
        return await promise;
    } catch (error) {
        words.textContent = error.message;
        throw error;
    }
}
const gltf = await told(new GLTFLoader().loadAsync(new URL('scene.glb', folder).href));
const relighter = await told(RelighterWorker.open(new URL('scene.relight', folder).href));
const lit = await told(LitObject.of(gltf.scene, relighter));
const world = new THREE.Scene().add(gltf.scene);
if (lit.rest)
    world.add(lit.rest);

/** A map as three.js loads it, without its alpha; or a blue sky with a warm lamp. */
async function sky() {
    if (asked.has('sky')) {
        const { HDRLoader } = await import('three/addons/loaders/HDRLoader.js');
        const { data, width, height } = (await new HDRLoader().setDataType(THREE.FloatType).loadAsync(asked.get('sky'))).image;
        return { latLong: data.filter((_, i) => i % 4 !== 3), width, height };
    }
    const width = 128, height = 64, latLong = new Float32Array(3 * width * height);
    for (let y = 0, i = 0; y < height; ++y)
        for (let x = 0; x < width; ++x, i += 3)
            latLong.set(Math.hypot(x - 90, y - 16) < 3 ? [60, 45, 30] : [0.2, 0.3, 0.5].map((c) => c * (1.5 - y / height)), i);
    return { latLong, width, height };
}

/** Light that changed bounces anew, and is shown. */
async function show() {
    if (relighter.info.hasBounces)
        await relighter.bounce();
    await lit.update();
}
await told(sky().then((map) => relighter.light({ ...map, resolution: 64 })));
await told(show());

const renderer = new THREE.WebGLRenderer({ antialias: true });
renderer.toneMapping = THREE.ACESFilmicToneMapping;
document.body.append(renderer.domElement);
const box = new THREE.Box3().setFromObject(gltf.scene), center = box.getCenter(new THREE.Vector3());
const size = box.getSize(new THREE.Vector3()).length();
const camera = new THREE.PerspectiveCamera(35, 1, size / 100, 20 * size);
camera.position.copy(center).add(new THREE.Vector3(0.5, 0.4, 1.2).multiplyScalar(size));
const controls = new OrbitControls(camera, renderer.domElement);
controls.target.copy(center);
const draw = () => {
    controls.update();
    renderer.render(world, camera);
};
controls.addEventListener('change', () => renderer.render(world, camera));
const fit = () => {
    renderer.setSize(innerWidth, innerHeight);
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
    draw();
};
addEventListener('resize', fit);
fit();

const slider = Object.assign(document.createElement('input'), { type: 'range', min: 0, max: 360, step: 1, value: 0 });
const said = document.createElement('span');
words.replaceChildren('The light turns ', slider, said);
let isTurning = false, degrees = 0;
slider.oninput = async () => {
    if (isTurning)
        return;
    for (isTurning = true; degrees !== slider.valueAsNumber;) {
        degrees = slider.valueAsNumber;
        const start = performance.now();
        await relighter.turn(degrees);
        await show();
        said.textContent = ` ${(performance.now() - start).toFixed(0)} ms for ${relighter.info.numReceivers} vertices`;
        draw();
    }
    isTurning = false;
};
document.title = 'Relumine: lit';
