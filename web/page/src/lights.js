// Lights that are put on the sphere around the scene: discs and soft boxes. Plain values; the worker and the page
// share these functions.

const radians = Math.PI / 180;
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const normalized = (a) => {
    const length = Math.hypot(...a);
    return [a[0] / length, a[1] / length, a[2] / length];
};

// Places (u, v) on cube faces, -1 to 1 to the right and down, to directions: as in cubemap/face.h.
export const onFaces = [
    (u, v) => [1, -v, u], (u, v) => [-1, -v, -u], (u, v) => [u, 1, -v],
    (u, v) => [u, -1, v], (u, v) => [-u, -v, 1], (u, v) => [u, -v, -1],
];

/** Colour of a black body, linear and with luminance 1: Krystek's fit of its place in CIE 1960, 1985. */
export function kelvinColor(kelvin) {
    const t = Math.min(Math.max(kelvin, 1000), 15000);
    const u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t);
    const v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t);
    const x = (3 * u) / (2 * u - 8 * v + 4), y = (2 * v) / (2 * u - 8 * v + 4);
    const [X, Y, Z] = [x / y, 1, (1 - x - y) / y];
    const rgb = [3.2406 * X - 1.5372 * Y - 0.4986 * Z, -0.9689 * X + 1.8758 * Y + 0.0415 * Z,
                 0.0557 * X - 0.204 * Y + 1.057 * Z].map((value) => Math.max(value, 0));
    const luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    return rgb.map((value) => value / luminance);
}

/** The frame of a light: its direction, and what is right and up on it as seen from the scene. */
export function frameOf(light) {
    const forward = normalized(light.direction);
    const pole = Math.abs(forward[1]) > 0.999 ? [0, 0, 1] : [0, 1, 0];
    const right = normalized(cross(forward, pole));
    return {forward, right, up: cross(right, forward)};
}

const smooth = (low, high, x) => {
    const t = Math.min(Math.max((x - low) / (high - low), 0), 1);
    return t * t * (3 - 2 * t);
};

/**
 * Returns a function from a unit direction to how much of the light is there, 0 to 1. `grain`: the size of what the
 * light is drawn on, degrees; edges are no sharper.
 */
export function coverageOf(light, grain = 0) {
    const {forward, right, up} = frameOf(light);
    if (light.type === 'disc') {
        const radius = light.size / 2, edge = Math.max(light.softness * radius, grain / 2);
        const inner = (radius - edge) * radians, outer = (radius + edge) * radians, farthest = Math.cos(Math.min(outer, Math.PI));
        return (w) => {
            const cosine = dot(w, forward);
            return cosine < farthest ? 0 : 1 - smooth(inner, outer, Math.acos(Math.min(cosine, 1)));
        };
    }
    const halfWidth = Math.tan(light.size / 2 * radians), halfHeight = Math.tan(light.size / light.aspect / 2 * radians);
    const least = Math.tan(grain / 2 * radians);
    const edgeX = Math.max(light.softness * halfWidth, least), edgeY = Math.max(light.softness * halfHeight, least);
    return (w) => {
        const along = dot(w, forward);
        if (along <= 0.01)
            return 0;
        const x = Math.abs(dot(w, right) / along), y = Math.abs(dot(w, up) / along);
        return (1 - smooth(halfWidth - edgeX, halfWidth + edgeX, x)) * (1 - smooth(halfHeight - edgeY, halfHeight + edgeY, y));
    };
}

/** Degrees from a light's middle within which all of it is. */
export function reachOf(light, grain) {
    if (light.type === 'disc')
        return light.size / 2 * (1 + light.softness) + grain;
    const side = (degrees) => Math.tan(degrees / 2 * radians) * (1 + light.softness) + Math.tan(grain * radians);
    return Math.atan(Math.hypot(side(light.size), side(light.size / light.aspect))) / radians;
}

/** Solid angle times the cosine to a surface that faces the light, sr: what turns irradiance into radiance. */
function projectedAngle(light) {
    const facing = {...light, direction: [0, 0, 1]};
    const {right, up} = frameOf(facing);
    const coverage = coverageOf(facing), reach = Math.min(reachOf(light, 0), 89) * radians;
    const steps = 48;
    let sum = 0;
    for (let i = 0; i < steps; ++i) {
        const angle = (i + 0.5) / steps * reach;
        for (let j = 0; j < steps; ++j) {
            const turn = (j + 0.5) / steps * 2 * Math.PI;
            const w = [0, 0, Math.cos(angle)].map((value, k) => value +
                Math.sin(angle) * (right[k] * Math.cos(turn) + up[k] * Math.sin(turn)));
            sum += coverage(w) * Math.cos(angle) * Math.sin(angle);
        }
    }
    return sum * (reach / steps) * (2 * Math.PI / steps);
}

// A light that is dragged keeps its shape, and the sum above takes as long as drawing the light.
const knownAngles = new Map();

function knownProjectedAngle(light) {
    const shape = JSON.stringify([light.type, light.size, light.aspect, light.softness]);
    if (!knownAngles.has(shape)) {
        if (knownAngles.size === 64)
            knownAngles.clear();
        knownAngles.set(shape, projectedAngle(light));
    }
    return knownAngles.get(shape);
}

/** Radiance of the light's middle. Its power is the irradiance of a surface that faces it, whatever its size. */
export function radianceOf(light) {
    const scale = light.on ? light.power / knownProjectedAngle(light) : 0;
    return kelvinColor(light.kelvin).map((value) => value * scale);
}
