// The lights as handles on a sphere around the picture's middle: dragged by pointer, moved by arrow keys.
import * as THREE from 'three';
import {kelvinColor, normalized} from './lights.js';

export class Handles {
    #elements = new Map();
    #layer;
    #ring;
    #stage;
    #drag;

    /** `on`: {change(light, isStep), select(id), selected(), remove(id)} */
    constructor(layer, stage, on) {
        this.#layer = layer;
        this.#stage = stage;
        this.on = on;
        this.#ring = document.createElement('div');
        this.#ring.className = 'sphere';
        layer.append(this.#ring);
    }

    set(lights) {
        for (const [id, element] of this.#elements)
            if (!lights.some((light) => light.id === id)) {
                element.remove();
                this.#elements.delete(id);
            }
        for (const light of lights) {
            if (!this.#elements.has(light.id))
                this.#elements.set(light.id, this.#made(light.id));
            const element = this.#elements.get(light.id);
            element.light = light;
            element.classList.toggle('off', !light.on);
            element.classList.toggle('box', light.type === 'box');
            element.classList.toggle('selected', this.on.selected() === light.id);
            element.setAttribute('aria-label', `${light.name}: drag, or move with the arrow keys`);
            const color = kelvinColor(light.kelvin);
            const most = Math.max(...color);
            element.style.setProperty('--light', `rgb(${color.map((value) => Math.round(255 * (value / most) ** (1 / 2.2)))})`);
        }
        this.place();
    }

    #made(id) {
        const element = document.createElement('button');
        element.className = 'handle';
        element.innerHTML = '<span></span>';
        element.addEventListener('pointerdown', (event) => this.#begin(event, element));
        element.addEventListener('pointermove', (event) => this.#move(event));
        for (const name of ['pointerup', 'pointercancel'])
            element.addEventListener(name, () => this.#end());
        element.addEventListener('keydown', (event) => this.#key(event, element.light));
        element.addEventListener('focus', () => this.on.select(id));
        this.#layer.append(element);
        return element;
    }

    /** The sphere in pixels, in the middle of what the controls leave free. */
    get #sphere() {
        const {width, height} = this.#stage.size, {right, bottom} = this.#stage.free;
        const radius = Math.max(40, 0.46 * Math.min(width - right - 40, height - bottom - 100));
        return {x: (width - right) / 2, y: (height - bottom) / 2, radius};
    }

    /** x to the right, y up, z towards the eye. */
    #toCamera(direction) {
        return new THREE.Vector3(...normalized(direction)).applyQuaternion(this.#stage.camera.quaternion.clone().invert());
    }

    #begin(event, element) {
        event.preventDefault();
        element.focus();
        element.setPointerCapture(event.pointerId);
        const {light} = element;
        this.on.select(light.id);
        const box = element.getBoundingClientRect();
        this.#drag = {
            light, side: this.#toCamera(light.direction).z < 0 ? -1 : 1, wasOutside: false,
            dx: event.clientX - (box.left + box.width / 2), dy: event.clientY - (box.top + box.height / 2),
        };
        this.#layer.classList.add('dragging');
    }

    #move(event) {
        if (!this.#drag)
            return;
        const canvas = this.#stage.renderer.domElement.getBoundingClientRect();
        const direction = this.#directionAt(event.clientX - this.#drag.dx - canvas.left, event.clientY - this.#drag.dy - canvas.top);
        this.on.change({...this.#drag.light, direction}, true);
    }

    /** Past the rim of the sphere a light goes to its other side. */
    #directionAt(x, y) {
        const sphere = this.#sphere, drag = this.#drag;
        const [u, v] = [(x - sphere.x) / sphere.radius, (sphere.y - y) / sphere.radius];
        const squared = u * u + v * v;
        let place;
        if (squared >= 1) {
            drag.wasOutside = true;
            place = new THREE.Vector3(u, v, 0).normalize();
        } else {
            if (drag.wasOutside)
                drag.side = -drag.side;
            drag.wasOutside = false;
            place = new THREE.Vector3(u, v, drag.side * Math.sqrt(1 - squared));
        }
        return place.applyQuaternion(this.#stage.camera.quaternion).normalize().toArray();
    }

    #end() {
        this.#layer.classList.remove('dragging');
        if (this.#drag)
            this.on.change(undefined, false);
        this.#drag = undefined;
    }

    #key(event, light) {
        const step = (event.shiftKey ? 15 : 3) * Math.PI / 180;
        const turns = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
        if (event.key === 'Delete' || event.key === 'Backspace') {
            event.preventDefault();
            this.on.remove(light.id);
        }
        if (!(event.key in turns))
            return;
        event.preventDefault();
        event.stopPropagation();
        const [x, y, z] = normalized(light.direction);
        const [around, up] = turns[event.key];
        const azimuth = Math.atan2(x, z) + around;
        const elevation = Math.min(Math.max(Math.asin(y) + up, -1.55), 1.55);
        const direction = [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
        this.on.change({...light, direction}, false);
    }

    /** Puts the handles where the camera sees them. */
    place() {
        if (!this.#stage.size)
            return;
        const sphere = this.#sphere;
        this.#ring.style.cssText = `left: ${sphere.x - sphere.radius}px; top: ${sphere.y - sphere.radius}px; width: ${2 * sphere.radius}px; height: ${2 * sphere.radius}px`;
        for (const element of this.#elements.values()) {
            const {x, y, z} = this.#toCamera(element.light.direction);
            element.style.transform = `translate(${sphere.x + x * sphere.radius}px, ${sphere.y - y * sphere.radius}px)`;
            element.classList.toggle('far', z < 0);
        }
    }
}
