// What is seen: the lit mesh, its floor, the environment behind, and the camera.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {Pace} from './pace.js';
import {FilteredEnvironment, hidingAlbedo, highlightFragment, highlightVertex, noLights, seenTexture, setLights} from './highlights.js';
import {latLongLookup, latLongTexture} from './sky.js';

const vertexShader = `
in vec3 radiance;
in vec3 albedo;
out vec3 lit;
out vec3 tint;
out vec2 place;
out vec3 world;
void main() {
    lit = radiance;
    tint = albedo;
    place = uv;
    world = position;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
#ifdef HIGHLIGHT
    findVisible();
#elif defined(GLOW)
    glowing = glow;
#endif
}`;

// Where glow is apart from light, matte surfaces have it, too.
const glowVertex = `
#if defined(GLOW) && !defined(HIGHLIGHT)
in vec3 glow;
out vec3 glowing;
#endif`, glowFragment = `
#if defined(GLOW) && !defined(HIGHLIGHT)
in vec3 glowing;
#endif`;

const screen = `
uniform float exposure;
uniform int curve;
vec3 encoded(vec3 linear) {
    return mix(12.92 * linear, 1.055 * pow(max(linear, 1e-6), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}
// Half a step of noise, so that slow gradients have no bands.
vec3 dithered(vec3 shown) {
    return shown + (fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) - 0.5) / 255.0;
}`;

const surfaceInputs = `
in vec3 lit;
in vec3 tint;
in vec2 place;
in vec3 world;
out vec4 color;
uniform sampler2D map;
uniform mat3 mapFromUv;
uniform vec3 emission;
uniform vec3 floorPlace; // x, z, radius; 0: no floor
uniform float alpha;`;

const surfaceShader = `
void main() {
    vec4 texel = texture(map, (mapFromUv * vec3(place, 1.0)).xy);
#ifdef HIGHLIGHT
    vec3 seen = shining(tint * texel.rgb, lit) + emission;
#elif defined(GLOW)
    vec3 seen = lit * tint * texel.rgb + glowing + emission;
#else
    vec3 seen = lit * tint * texel.rgb + emission;
#endif
    float shown = alpha;
    if (floorPlace.z > 0.0)
        shown = 1.0 - smoothstep(0.4, 1.0, distance(world.xz, floorPlace.xy) / floorPlace.z);
    color = vec4(dithered(encoded(on_screen(curve, seen * exposure))), shown);
}`;

const skyVertexShader = `
out vec2 at;
void main() {
    at = position.xy;
    gl_Position = vec4(position.xy, 1.0, 1.0);
}`;

const skyShader = `
in vec2 at;
out vec4 color;
uniform mat4 worldFromClip;
uniform sampler2D sky;
uniform float turn;
uniform vec3 plainLow;
uniform vec3 plainHigh;
uniform float isPlain;
${latLongLookup}
void main() {
    vec4 far = worldFromClip * vec4(at, 1.0, 1.0);
    vec4 near = worldFromClip * vec4(at, -1.0, 1.0);
    vec3 w = normalize(far.xyz / far.w - near.xyz / near.w);
    if (isPlain > 0.5) {
        vec3 plain = mix(plainLow, plainHigh, smoothstep(-0.6, 0.7, w.y));
        color = vec4(dithered(plain), 1.0);
        return;
    }
    color = vec4(dithered(encoded(on_screen(curve, latLong(sky, w, turn) * exposure))), 1.0);
}`;

function white() {
    const texture = new THREE.DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
    texture.needsUpdate = true;
    return texture;
}

export class Stage {
    #shared;
    #shining;
    #lights;
    #filter;
    free = {right: 0, bottom: 0};
    #white = white();

    constructor(canvas, toneSource) {
        this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, powerPreference: 'high-performance'});
        this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // the shaders do it
        this.toneSource = toneSource;
        this.scene = new THREE.Scene();
        this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.enableDamping = true;
        this.controls.dampingFactor = 0.12;
        this.controls.addEventListener('change', () => this.ask());
        this.#shared = {exposure: {value: 1}, curve: {value: 0}};
        this.#shining = {
            seen: {value: null}, seenSize: {value: new THREE.Vector2()}, filtered: {value: null}, lastLevel: {value: 0},
            turn: {value: 0}, numLights: {value: 0}, lightForward: {value: null}, lightRight: {value: null},
            lightUp: {value: null}, lightRadiance: {value: null},
        };
        this.#makeRoomForLights(8);
        this.#addSky();
        this.onFrame = () => {};
        this.pace = new Pace({draw: () => this.draw(), drawn: () => this.#drawn(), rescaled: () => this.#setPixels()});
    }

    #addSky() {
        this.sky = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3, depthTest: false, depthWrite: false,
            vertexShader: skyVertexShader,
            fragmentShader: `${screen}\n${this.toneSource}\n${skyShader}`,
            uniforms: {
                ...this.#shared, worldFromClip: {value: new THREE.Matrix4()}, sky: {value: this.#white}, turn: {value: 0},
                isPlain: {value: 1}, plainLow: {value: new THREE.Color()}, plainHigh: {value: new THREE.Color()},
            },
        });
        const triangle = new THREE.BufferGeometry();
        triangle.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
        const mesh = new THREE.Mesh(triangle, this.sky);
        mesh.frustumCulled = false;
        mesh.renderOrder = -1;
        this.scene.add(mesh);
    }

    /** Shows a mesh: arrays, groups [{start, count, material}] and their materials. */
    setMesh({positions, normals, triangles, uvs, albedo, groups, materials, floor, receivers, hasHighlights}) {
        const count = positions.length / 3;
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
        geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
        geometry.setAttribute('uv', new THREE.BufferAttribute(uvs ?? new Float32Array(2 * count), 2));
        geometry.setAttribute('albedo', new THREE.BufferAttribute(albedo, 3));
        this.radiance = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
        this.radiance.setUsage(THREE.DynamicDrawUsage);
        geometry.setAttribute('radiance', this.radiance);
        if (hasHighlights) {
            const numbers = receivers ? Float32Array.from(receivers) : Float32Array.from({length: count}, (_, i) => i);
            geometry.setAttribute('receiver', new THREE.BufferAttribute(numbers, 1));
            this.open = new THREE.BufferAttribute(new Float32Array(count), 1);
            geometry.setAttribute('open', this.open);
            this.glow = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
            geometry.setAttribute('glow', this.glow);
        }
        geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
        for (const {start, count: size, material} of groups)
            geometry.addGroup(start, size, material);
        this.mesh = new THREE.Mesh(geometry, materials.map((material) => this.#material(material, floor)));
        this.mesh.frustumCulled = false;
        this.scene.add(this.mesh);
    }

    #material({map, mapFromUv, emission, isFloor, isOneSide, alpha = 1, highlight}, floor) {
        const defines = {};
        if (this.glow)
            defines.GLOW = '';
        if (highlight) {
            defines.HIGHLIGHT = '';
            defines.HIDING_ALBEDO = hidingAlbedo;
            defines.MOST_LIGHTS = this.#lights.forward.length;
            if (highlight.normalMap)
                defines.NORMAL_MAP = '';
        }
        return new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3, defines, vertexShader: `${highlight ? highlightVertex : glowVertex}\n${vertexShader}`,
            fragmentShader: [screen, this.toneSource, surfaceInputs, highlight ? highlightFragment : glowFragment, surfaceShader].join('\n'),
            side: isOneSide ? THREE.FrontSide : THREE.DoubleSide, transparent: isFloor === true || alpha < 1, depthWrite: alpha === 1 && isFloor !== true,
            uniforms: {
                ...this.#shared, ...(highlight ? {...this.#shining, ...this.#highlightUniforms(highlight)} : {}), map: {value: map ?? this.#white}, mapFromUv: {value: mapFromUv ?? new THREE.Matrix3()},
                emission: {value: new THREE.Vector3(...(emission ?? [0, 0, 0]))}, alpha: {value: alpha},
                floorPlace: {value: isFloor ? new THREE.Vector3(floor.center[0], floor.center[2], floor.radius) : new THREE.Vector3()},
            },
        });
    }

    #highlightUniforms({roughness, metallic, f0, f90, roughnessMap, metallicMap, f0Map, normalMap, normalScale = 1, glowMap}) {
        const texture = (map) => ({value: map?.texture ?? this.#white});
        const place = (map) => ({value: map?.fromUv ?? new THREE.Matrix3()});
        const channel = (map) => ({value: new THREE.Vector4(...[0, 1, 2, 3].map((i) => (i === (map?.channel ?? 0) ? 1 : 0)))});
        // Where v goes down, so does the bitangent that derivatives give.
        const scaleOfY = normalMap?.fromTop ? -normalScale : normalScale;
        return {
            roughness: {value: roughness}, metallic: {value: metallic}, f0: {value: new THREE.Vector3(...f0)}, f90: {value: f90},
            roughnessMap: texture(roughnessMap), roughnessFromUv: place(roughnessMap), roughnessChannel: channel(roughnessMap),
            metallicMap: texture(metallicMap), metallicFromUv: place(metallicMap), metallicChannel: channel(metallicMap),
            f0Map: texture(f0Map), f0FromUv: place(f0Map), normalMap: texture(normalMap), normalFromUv: place(normalMap),
            normalScale: {value: new THREE.Vector2(normalScale, scaleOfY)}, glowMap: texture(glowMap), glowFromUv: place(glowMap),
        };
    }

    /** What vertices see of the sky: `parts` answer skyQuestion(), `open` is how much drawn ones see of all of it. */
    setSeen({parts, cells, open}) {
        this.open.array.set(open);
        this.open.needsUpdate = true;
        const {texture, inLayer} = seenTexture(parts, cells, this.renderer.capabilities.maxTextureSize);
        this.#shining.seen.value = texture;
        this.#shining.seenSize.value.set(cells, inLayer);
    }

    /** What highlights mirror, before any turn. */
    setMirrored(picture) {
        this.#filter ??= new FilteredEnvironment(this.renderer);
        this.#filter.filter(picture);
        this.#shining.filtered.value = this.#filter.texture;
        this.#shining.lastLevel.value = this.#filter.lastLevel;
        this.ask();
    }

    #makeRoomForLights(capacity) {
        this.#lights = noLights(capacity);
        for (const name of ['forward', 'right', 'up', 'radiance'])
            this.#shining[`light${name[0].toUpperCase()}${name.slice(1)}`].value = this.#lights[name];
        for (const material of this.mesh?.material ?? [])
            if (material.defines.MOST_LIGHTS !== undefined) {
                material.defines.MOST_LIGHTS = capacity;
                material.needsUpdate = true;
            }
    }

    /** Lights that highlights mirror, with their power. */
    setLights(lights) {
        let capacity = this.#lights.forward.length;
        while (capacity < lights.length)
            capacity *= 2;
        if (capacity > this.#lights.forward.length)
            this.#makeRoomForLights(capacity);
        setLights(this.#lights, lights);
        this.#shining.numLights.value = this.#lights.count;
        this.ask();
    }

    /** Radiance of what glows, of the drawn vertices. */
    setGlow(glow) {
        this.glow.array.set(glow);
        this.glow.needsUpdate = true;
        this.ask();
    }

    /** Returns the array that was shown before, to be filled again. */
    setRadiance(radiance) {
        const before = this.radiance.array;
        this.isLit = true;
        this.radiance.array = radiance;
        this.radiance.needsUpdate = true;
        this.ask();
        return before;
    }

    /** Shows what skyPixels() made behind the scene. */
    setSky(pixels) {
        this.sky.uniforms.sky.value.dispose?.();
        this.sky.uniforms.sky.value = latLongTexture(pixels);
        this.ask();
    }

    setLook({exposure, curve, turn, isPlain, plain}) {
        this.#shared.exposure.value = 2 ** exposure;
        this.#shared.curve.value = curve;
        this.sky.uniforms.turn.value = turn * Math.PI / 180;
        this.#shining.turn.value = turn * Math.PI / 180;
        this.sky.uniforms.isPlain.value = isPlain ? 1 : 0;
        if (plain) {
            this.sky.uniforms.plainLow.value.setRGB(...plain[0]);
            this.sky.uniforms.plainHigh.value.setRGB(...plain[1]);
        }
        this.ask();
    }

    /** The camera of the scene's pictures, farther away where the window is narrow. */
    setCamera({eye, target, fov, radius}) {
        this.home = {eye, target, fov, radius};
        const aspect = this.camera.aspect;
        const scale = aspect < 1.2 ? 1.2 / Math.max(aspect, 0.45) : 1;
        this.camera.fov = fov;
        this.controls.target.set(...target);
        this.camera.position.set(...eye).sub(this.controls.target).multiplyScalar(scale).add(this.controls.target);
        this.controls.minDistance = 0.3 * radius;
        this.controls.maxDistance = 40 * radius;
        this.camera.near = 0.01 * radius;
        this.camera.far = 200 * radius;
        this.camera.updateProjectionMatrix();
        this.controls.update();
        this.ask();
    }

    /** The part of the picture, in pixels, that controls leave free: its middle shows the camera's target. */
    setFree({right, bottom}) {
        this.free = {right, bottom};
        this.#centre();
    }

    #centre() {
        const {width, height} = this.size, {right, bottom} = this.free;
        this.camera.setViewOffset(width, height, right / 2, bottom / 2, width, height);
        this.ask();
    }

    resize(width, height) {
        if (width === 0 || height === 0)
            return;
        this.size = {width, height};
        this.#setPixels();
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.#centre();
    }

    /** As many pixels as the screen has, or fewer: the pace's scale of each edge. */
    #setPixels() {
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * this.pace.scale);
        this.renderer.setSize(this.size.width, this.size.height, false);
    }

    /** Draws at the next frame of the screen; not before there is light: nobody sees it, and without a GPU it takes long. */
    ask() {
        if (this.isLit)
            this.pace.ask();
    }

    /** Whether all is drawn that was asked for, in full. */
    get isAtRest() { return this.pace.isAtRest; }

    draw() {
        if (this.controls.update())
            this.ask();
        this.camera.updateMatrixWorld();
        this.sky.uniforms.worldFromClip.value
            .copy(this.camera.projectionMatrix).multiply(this.camera.matrixWorldInverse).invert();
        this.renderer.render(this.scene, this.camera);
        this.onFrame();
    }

    /** Resolves when all that was asked of the GPU is drawn. */
    async #drawn() {
        const gl = this.renderer.getContext();
        const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        while (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost())
            await new Promise((resolve) => setTimeout(resolve, 4));
        gl.deleteSync(fence);
    }

    /** Of the camera about the target, from +Z to +X. */
    get azimuth() {
        const {x, z} = this.camera.position.clone().sub(this.controls.target);
        return Math.atan2(x, z);
    }

    /** Turns the camera by steps of 10 degrees: to the right and up. */
    orbit([right, up]) {
        const offset = this.camera.position.clone().sub(this.controls.target);
        const place = new THREE.Spherical().setFromVector3(offset);
        place.theta += right * Math.PI / 18;
        place.phi = Math.min(Math.max(place.phi - up * Math.PI / 18, 0.05), Math.PI - 0.05);
        this.camera.position.setFromSpherical(place).add(this.controls.target);
        this.controls.update();
        this.ask();
    }

    /** The point of the mesh under a place of the canvas, in pixels; undefined beside the mesh. */
    hit(x, y) {
        const ray = new THREE.Raycaster();
        ray.setFromCamera(new THREE.Vector2(2 * x / this.size.width - 1, 1 - 2 * y / this.size.height), this.camera);
        const [first] = ray.intersectObject(this.mesh, false);
        if (!first)
            return undefined;
        const corners = [first.face.a, first.face.b, first.face.c];
        const {position} = this.mesh.geometry.attributes;
        const distance = (vertex) => new THREE.Vector3().fromBufferAttribute(position, vertex).distanceTo(first.point);
        corners.sort((a, b) => distance(a) - distance(b));
        return {point: first.point, vertex: corners[0]};
    }

    /** Where a point of the world is on the canvas, and whether it is in front of the camera. */
    onCanvas(point) {
        const p = new THREE.Vector3(...point).project(this.camera);
        return {x: (p.x + 1) / 2 * this.size.width, y: (1 - p.y) / 2 * this.size.height, isInFront: p.z < 1};
    }

    end() {
        this.pace.end();
        this.controls.dispose();
        this.#filter?.dispose();
        this.renderer.dispose();
    }
}
