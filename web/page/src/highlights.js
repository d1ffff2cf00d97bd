// Highlights: what surfaces mirror of the environment and of the lights, as three.js draws it (a prefiltered
// environment, split sums, light scattered several times), darkened by what our clusters see of the sky towards the
// mirrored eye.
//
// The environment is filtered once; a turn turns what is looked up. The lights' highlights are a formula, so a light
// that is dragged costs nothing but the drawing.
import * as THREE from 'three';
import {shrunk} from './environments.js';
import {frameOf, radianceOf} from './lights.js';
import {halfPixels, latLongLookup, latLongTexture} from './sky.js';

/** What surfaces that hide the sky send back of their light: the mean of usual ones. */
export const hidingAlbedo = 0.4;

// --- what vertices see of the sky ---

/** Cells along the edge of a vertex's square: 13 degrees each, 25 for scenes whose squares would be too large. */
const cellsFor = (numReceivers) => (numReceivers <= 150000 ? 16 : 8);
/** Radians: cones of neighbouring cells overlap a little. */
const radiusOf = (cells) => 2.5 / cells;

/** Octahedral map: a place of [-1, 1]^2 to a direction. Places beyond go on at the other side of the edge. */
function octahedral(u, v) {
    if (Math.abs(u) > 1)
        [u, v] = [Math.sign(u) * 2 - u, -v];
    if (Math.abs(v) > 1)
        [u, v] = [-u, Math.sign(v) * 2 - v];
    const y = 1 - Math.abs(u) - Math.abs(v);
    return y >= 0 ? [u, y, v] : [Math.sign(u) * (1 - Math.abs(v)), y, Math.sign(v) * (1 - Math.abs(u))];
}

/** What the worker is asked: a square of directions with a border of one cell, so that squares can be filtered. */
export function skyQuestion(numReceivers) {
    const cells = cellsFor(numReceivers), directions = [];
    for (let y = -1; y <= cells; ++y)
        for (let x = -1; x <= cells; ++x)
            directions.push(...octahedral((2 * x + 1) / cells - 1, (2 * y + 1) / cells - 1));
    return {directions, radius: radiusOf(cells), cells, numReceivers};
}

/** The answer as a texture: the squares of vertices one below the other, in as many layers as it takes. */
export function seenTexture(parts, cells, maxSize) {
    const edge = cells + 2, numReceivers = parts.length / edge ** 2;
    const inLayer = Math.min(Math.floor(Math.min(maxSize, 8192) / edge), numReceivers);
    const layers = Math.ceil(numReceivers / inLayer);
    const size = layers * inLayer * edge ** 2;
    let data = parts;
    if (data.length < size) {
        data = new Uint8Array(size);
        data.set(parts);
    }
    const texture = new THREE.DataArrayTexture(data, edge, inLayer * edge, layers);
    texture.format = THREE.RedFormat;
    texture.minFilter = THREE.LinearFilter;
    texture.magFilter = THREE.LinearFilter;
    texture.unpackAlignment = 1;
    texture.needsUpdate = true;
    return {texture, cells, inLayer};
}

// --- the environment ---

const filteredSize = 256, lastLevel = 5;
/** Each of a level's texels is a mean of so many samples, which are means themselves: of the environment's mips. */
const samplesOf = (level) => (level < 3 ? 32 : 64);
/** three.js's: levels get closer to each other where highlights are sharp. */
const roughnessOf = (level) => 1 - Math.sqrt(1 - level / lastLevel);

// Directions of a cube map's texels, as OpenGL has them: right, down, middle.
const faces = [[[0, 0, -1], [0, -1, 0], [1, 0, 0]], [[0, 0, 1], [0, -1, 0], [-1, 0, 0]], [[1, 0, 0], [0, 0, 1], [0, 1, 0]],
               [[1, 0, 0], [0, 0, -1], [0, -1, 0]], [[1, 0, 0], [0, -1, 0], [0, 0, 1]], [[-1, 0, 0], [0, -1, 0], [0, 0, -1]]]
    .map(([right, down, middle]) => new THREE.Matrix3().set(right[0], down[0], middle[0], right[1], down[1], middle[1],
                                                            right[2], down[2], middle[2]));

const faceVertex = `
out vec3 towards;
uniform mat3 face;
void main() {
    towards = face * vec3(position.xy, 1.0);
    gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const latLongShader = `
in vec3 towards;
out vec4 color;
uniform sampler2D environment;
${latLongLookup}
void main() {
    color = vec4(latLong(environment, normalize(towards), 0.0), 1.0);
}`;

// A GGX lobe seen along its normal, sampled where it is: Heitz, "Sampling the GGX Distribution of Visible Normals", 2018.
const lobeShader = `
in vec3 towards;
out vec4 color;
uniform samplerCube source;
uniform float alpha;
uniform float size;
uniform int samples;
void main() {
    vec3 n = normalize(towards);
    vec3 side = normalize(cross(abs(n.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0), n)), up = cross(n, side);
    float a = alpha * alpha;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < samples; ++i) {
        float part = (float(i) + 0.5) / float(samples), turn = 2.39996323 * float(i);
        float scale = 1.0 / (1.0 - part + a * part);
        float cosine = (1.0 - part - a * part) * scale;
        if (cosine <= 0.0)
            continue;
        float sine = 2.0 * alpha * sqrt(part * (1.0 - part)) * scale;
        vec3 w = cosine * n + sine * (cos(turn) * side + sin(turn) * up);
        // The sample stands for its share of the lobe: the level whose texels are as large, and a half to be smooth.
        float density = 1.0 / (4.0 * 3.14159265 * a * scale * scale);
        float texels = 6.0 * size * size / (12.5663706 * density * float(samples));
        sum += vec4(textureLod(source, w, max(0.5 * log2(texels) + 1.0, 0.0)).rgb, 1.0) * cosine;
    }
    color = vec4(sum.rgb / sum.a, 1.0);
}`;

/**
 * Filters environments for all roughnesses, as three.js's PMREMGenerator does with 256 samples for each texel: that
 * takes seconds where there is no GPU.
 */
export class FilteredEnvironment {
    #renderer;
    #scene = new THREE.Scene();
    #camera = new THREE.Camera();
    #mesh;
    #latLong;
    #lobe;
    #source = cubeTarget(true);
    #target = cubeTarget(false);

    constructor(renderer) {
        this.#renderer = renderer;
        const triangle = new THREE.BufferGeometry();
        triangle.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
        this.#mesh = new THREE.Mesh(triangle);
        this.#mesh.frustumCulled = false;
        this.#scene.add(this.#mesh);
        const shader = (fragmentShader, uniforms) => new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3, vertexShader: faceVertex, fragmentShader, side: THREE.DoubleSide,
            depthTest: false, depthWrite: false, blending: THREE.NoBlending, uniforms: {face: {value: null}, ...uniforms},
        });
        this.#latLong = shader(latLongShader, {environment: {value: null}});
        this.#lobe = shader(lobeShader, {source: {value: this.#source.texture}, alpha: {value: 0}, size: {value: filteredSize},
                                         samples: {value: 0}});
    }

    get texture() { return this.#target.texture; }
    get lastLevel() { return lastLevel; }

    filter(picture) {
        const latLong = latLongTexture(halfPixels(shrunk(picture, 4 * filteredSize)));
        this.#latLong.uniforms.environment.value = latLong;
        this.#draw(this.#source, 0, this.#latLong);
        this.#draw(this.#target, 0, this.#latLong);
        for (let level = 1; level <= lastLevel; ++level) {
            this.#lobe.uniforms.alpha.value = roughnessOf(level) ** 2;
            this.#lobe.uniforms.samples.value = samplesOf(level);
            this.#draw(this.#target, level, this.#lobe);
        }
        this.#renderer.setRenderTarget(null);
        latLong.dispose();
    }

    #draw(target, level, material) {
        this.#mesh.material = material;
        target.viewport.set(0, 0, filteredSize >> level, filteredSize >> level);
        // Mips are made when the last face is there.
        const makesMips = target.texture.generateMipmaps;
        for (let face = 0; face < 6; ++face) {
            target.texture.generateMipmaps = makesMips && face === 5;
            material.uniforms.face.value = faces[face];
            material.uniformsNeedUpdate = true;
            this.#renderer.setRenderTarget(target, face, level);
            this.#renderer.render(this.#scene, this.#camera);
        }
        target.texture.generateMipmaps = makesMips;
    }

    dispose() {
        for (const own of [this.#source, this.#target, this.#latLong, this.#lobe, this.#mesh.geometry])
            own.dispose();
    }
}

function cubeTarget(makesMips) {
    const target = new THREE.WebGLCubeRenderTarget(filteredSize, {
        minFilter: THREE.LinearMipmapLinearFilter, generateMipmaps: makesMips, type: THREE.HalfFloatType,
        colorSpace: THREE.LinearSRGBColorSpace, depthBuffer: false,
    });
    for (let level = 0; !makesMips && level <= lastLevel; ++level)
        target.texture.mipmaps.push({width: filteredSize >> level, height: filteredSize >> level});
    return target;
}

// --- the lights ---

/** Numbers of so many lights for the shader. */
export function noLights(capacity) {
    const vectors = (Type) => Array.from({length: capacity}, () => new Type());
    return {count: 0, forward: vectors(THREE.Vector4), right: vectors(THREE.Vector3), up: vectors(THREE.Vector3),
            radiance: vectors(THREE.Vector4)};
}

/** Fills the numbers of lights that are on; there must be room for all. */
export function setLights(numbers, lights) {
    const radians = Math.PI / 180;
    const shining = lights.filter((light) => light.on);
    numbers.count = shining.length;
    shining.forEach((light, i) => {
        const {forward, right, up} = frameOf(light);
        const isDisc = light.type === 'disc';
        const width = isDisc ? light.size / 2 * radians : Math.tan(light.size / 2 * radians);
        const height = isDisc ? width : Math.tan(light.size / light.aspect / 2 * radians);
        numbers.forward[i].set(...forward, isDisc ? width : 0);
        numbers.right[i].set(...right).multiplyScalar(width);
        numbers.up[i].set(...up).multiplyScalar(height);
        numbers.radiance[i].set(...radianceOf(light), light.softness * Math.min(width, height));
    });
}

// --- shaders ---

export const highlightVertex = `
uniform highp sampler2DArray seen;
uniform ivec2 seenSize; // cells along an edge, squares in a layer
uniform float roughness;
uniform sampler2D roughnessMap;
uniform mat3 roughnessFromUv;
uniform vec4 roughnessChannel;
in float receiver;
in float open;
in vec3 glow;
out vec3 glowing;
out vec3 facing;
out float visible;
out float hiding;

float seenTowards(vec3 w) {
    w /= abs(w.x) + abs(w.y) + abs(w.z);
    vec2 at = w.xz;
    if (w.y < 0.0)
        at = (1.0 - abs(w.zx)) * vec2(w.x < 0.0 ? -1.0 : 1.0, w.z < 0.0 ? -1.0 : 1.0);
    float cells = float(seenSize.x), edge = cells + 2.0;
    vec2 place = 1.0 + (0.5 * at + 0.5) * cells;
    int own = int(receiver), layer = own / seenSize.y;
    float square = float(own - layer * seenSize.y);
    return textureLod(seen, vec3(place.x / edge, (square * edge + place.y) / (float(seenSize.y) * edge), float(layer)), 0.0).r;
}

// The mean over the lobe: its middle, and a ring where half of what it mirrors is farther out.
float seenOfLobe(vec3 n, vec3 mirrored, float alpha) {
    float angle = 2.0 * atan(0.8 * alpha);
    vec3 side = normalize(cross(mirrored, abs(mirrored.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 up = cross(side, mirrored);
    vec2 sum = vec2(seenTowards(mirrored), 1.0) * max(dot(n, mirrored), 0.02);
    for (int i = 0; i < 5; ++i) {
        float turn = 1.25663706 * float(i);
        vec3 w = cos(angle) * mirrored + sin(angle) * (cos(turn) * side + sin(turn) * up);
        sum += vec2(seenTowards(w), 1.0) * max(dot(n, w), 0.0);
    }
    return sum.x / sum.y;
}

void findVisible() {
    facing = normal;
    glowing = glow;
    vec3 v = normalize(cameraPosition - position);
    vec3 n = dot(normal, v) < 0.0 ? -normal : normal;
    vec4 texel = textureLod(roughnessMap, (roughnessFromUv * vec3(uv, 1.0)).xy, 3.0);
    float own = roughness * dot(texel, roughnessChannel);
    visible = seenOfLobe(n, reflect(-v, n), own * own);
    // What hides the sky is lit by the same light, of which it sends back a part. So a point that gets light from the sky
    // by \`open\`, and from what hides it by the rest, has the light that it has.
    hiding = HIDING_ALBEDO / mix(HIDING_ALBEDO, 1.0, clamp(open, 0.0, 1.0));
}`;

export const highlightFragment = `
in vec3 glowing;
in vec3 facing;
in float visible;
in float hiding; // radiance of what hides the sky, over what arrives here
uniform samplerCube filtered;
uniform float lastLevel;
uniform float turn;
uniform int numLights;
uniform vec4 lightForward[MOST_LIGHTS]; // w: a disc's radius, radians; 0: a box
uniform vec3 lightRight[MOST_LIGHTS];
uniform vec3 lightUp[MOST_LIGHTS];
uniform vec4 lightRadiance[MOST_LIGHTS]; // w: half the width of the soft edge
uniform float roughness;
uniform float metallic;
uniform vec3 f0;
uniform float f90;
uniform sampler2D roughnessMap;
uniform mat3 roughnessFromUv;
uniform vec4 roughnessChannel;
uniform sampler2D metallicMap;
uniform mat3 metallicFromUv;
uniform vec4 metallicChannel;
uniform sampler2D f0Map;
uniform mat3 f0FromUv;
uniform sampler2D normalMap;
uniform mat3 normalFromUv;
uniform vec2 normalScale;
uniform sampler2D glowMap;
uniform mat3 glowFromUv;

vec3 shadingNormal() {
    vec3 n = normalize(facing) * (gl_FrontFacing ? 1.0 : -1.0);
#ifdef NORMAL_MAP
    vec2 at = (normalFromUv * vec3(place, 1.0)).xy;
    // Tangents by derivatives, as three.js has them where a mesh brings none.
    vec3 q0 = dFdx(world), q1 = dFdy(world);
    vec2 st0 = dFdx(at), st1 = dFdy(at);
    vec3 q1perp = cross(q1, n), q0perp = cross(n, q0);
    vec3 t = q1perp * st0.x + q0perp * st1.x, b = q1perp * st0.y + q0perp * st1.y;
    float most = max(dot(t, t), dot(b, b));
    float scale = most == 0.0 ? 0.0 : inversesqrt(most);
    vec3 texel = 2.0 * texture(normalMap, at).xyz - 1.0;
    texel.xy *= normalScale;
    n = normalize(mat3(t * scale, b * scale, n) * texel);
#endif
    return n;
}

// In the plane of a stereographic projection from behind the mirrored eye, a GGX lobe seen along its normal is what a
// plate of the same size would get at the height alpha, exactly: alpha^2 / pi (alpha^2 + x^2)^2. Discs stay discs there.
float discInLobe(float angle, float radius, float alpha) {
    float low = tan(0.5 * (angle - radius)), high = tan(0.5 * min(angle + radius, 3.0));
    float c = 0.5 * (low + high), r = 0.5 * (high - low);
    float s = c * c + alpha * alpha;
    return 0.5 - 0.5 * (s - r * r) * inversesqrt(max((s + r * r) * (s + r * r) - 4.0 * c * c * r * r, 1e-12));
}

vec3 inPlane(vec3 corner, vec3 m, float alpha) {
    vec3 w = normalize(corner);
    float along = dot(w, m);
    return normalize((w - along * m) / max(1.0 + along, 0.05) + alpha * m);
}

float edgeInLobe(vec3 p, vec3 q, vec3 m) {
    float cosine = clamp(dot(p, q), -0.9999, 0.999999);
    return dot(cross(p, q), m) * acos(cosine) * inversesqrt(1.0 - cosine * cosine);
}

// Lambert's formula for the box's corners in that plane, whose edges are taken to be straight.
float boxInLobe(int i, vec3 m, float alpha) {
    vec3 f = lightForward[i].xyz, x = lightRight[i], y = lightUp[i];
    vec3 a = inPlane(f - x - y, m, alpha), b = inPlane(f + x - y, m, alpha);
    vec3 c = inPlane(f + x + y, m, alpha), d = inPlane(f - x + y, m, alpha);
    return abs(edgeInLobe(a, b, m) + edgeInLobe(b, c, m) + edgeInLobe(c, d, m) + edgeInLobe(d, a, m)) / 6.28318531;
}

// The prefiltered environment weights a lobe with the cosine: the mean of its weights.
float meanCosine(float alpha) {
    float a = min(alpha * alpha, 0.97), rest = 1.0 - a;
    return 1.0 / rest + 2.0 * a / (rest * rest) * log(2.0 * a / (1.0 + a));
}

vec3 mirroredLights(vec3 m, float alpha) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < MOST_LIGHTS; ++i) {
        if (i >= numLights)
            break;
        vec3 f = lightForward[i].xyz;
        float along = dot(m, f), edge = lightRadiance[i].w;
        if (along < -0.5)
            continue;
        float soft = sqrt(alpha * alpha + 0.068 * edge * edge);
        float part = lightForward[i].w > 0.0 ? discInLobe(atan(length(cross(m, f)), along), lightForward[i].w, soft)
                                             : boxInLobe(i, m, soft);
        sum += min(part * max(along, 0.0) / meanCosine(alpha), 1.0) * lightRadiance[i].rgb;
    }
    return sum;
}

vec3 mirroredEnvironment(vec3 w, float rough) {
    float s = sin(turn), c = cos(turn);
    vec3 turned = vec3(c * w.x - s * w.z, w.y, c * w.z + s * w.x);
    return textureLod(filtered, turned, lastLevel * rough * (2.0 - rough)).rgb;
}

// Scale and bias of F0 in the split sum: Karis, "Physically Based Shading on Mobile", 2014.
vec2 splitSum(float rough, float nv) {
    vec4 r = rough * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

// Light scattered once and several times: Fdez-Aguera, 2019, as in three.js.
void scattered(vec2 fab, vec3 own, float grazing, out vec3 once, out vec3 several) {
    once = own * fab.x + grazing * fab.y;
    float left = 1.0 - fab.x - fab.y;
    vec3 mean = own + (1.0 - own) * 0.047619;
    several = once * mean / (1.0 - left * mean) * left;
}

// \`base\`: the colour; \`arriving\`: radiance for albedo 1.
vec3 shining(vec3 base, vec3 arriving) {
    float rough = clamp(roughness * dot(texture(roughnessMap, (roughnessFromUv * vec3(place, 1.0)).xy), roughnessChannel), 0.05, 1.0);
    float metal = metallic * dot(texture(metallicMap, (metallicFromUv * vec3(place, 1.0)).xy), metallicChannel);
    vec3 own = f0 * texture(f0Map, (f0FromUv * vec3(place, 1.0)).xy).rgb;
    vec3 n = shadingNormal(), v = normalize(cameraPosition - world);
    vec2 fab = splitSum(rough, clamp(dot(n, v), 0.0, 1.0));
    vec3 onceGlass, severalGlass, onceMetal, severalMetal;
    scattered(fab, own, f90, onceGlass, severalGlass);
    scattered(fab, base, 1.0, onceMetal, severalMetal);
    vec3 once = mix(onceGlass, onceMetal, metal), several = mix(severalGlass, severalMetal, metal);
    vec3 m = reflect(-v, n);
    vec3 mirrored = mirroredEnvironment(normalize(mix(m, n, rough * rough * rough * rough)), rough) +
        mirroredLights(m, rough * rough);
    vec3 diffuse = base * (1.0 - metal) * (1.0 - onceGlass - severalGlass);
    vec3 glowed = glowing * texture(glowMap, (glowFromUv * vec3(place, 1.0)).xy).rgb;
    return (diffuse + several) * arriving + once * mix(hiding * arriving, mirrored, visible) + glowed;
}`;
