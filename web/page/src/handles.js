// The lights as handles on a sphere around the scene: dragged by pointer, moved by arrow keys.
import * as THREE from 'three';
import {kelvinColor, normalized} from './lights.js';

export class Handles {
    #elements = new Map();
    #layer;
    #stage;
    #drag;

    /** `on`: {change(light, isStep), select(id), selected(), remove(id)} */
    constructor(layer, stage, {center, radius}, on) {
        this.#layer = layer;
        this.#stage = stage;
        this.center = new THREE.Vector3(...center);
        this.radius = radius;
        this.on = on;
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

    #begin(event, element) {
        event.preventDefault();
        element.focus();
        element.setPointerCapture(event.pointerId);
        const {light} = element;
        this.on.select(light.id);
        const box = element.getBoundingClientRect();
        this.#drag = {
            light, isFar: this.#isFar(light.direction), wasOutside: false,
            dx: event.clientX - (box.left + box.width / 2), dy: event.clientY - (box.top + box.height / 2),
        };
    }

    #isFar(direction) {
        const toCamera = this.#stage.camera.position.clone().sub(this.center);
        return toCamera.dot(new THREE.Vector3(...direction)) < this.radius;
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
        const {camera, size} = this.#stage;
        const ray = new THREE.Raycaster();
        ray.setFromCamera(new THREE.Vector2(2 * x / size.width - 1, 1 - 2 * y / size.height), camera);
        const {origin, direction} = ray.ray;
        const toCenter = this.center.clone().sub(origin);
        const along = toCenter.dot(direction);
        const squared = this.radius ** 2 - (toCenter.lengthSq() - along ** 2);
        if (squared < 0) {
            this.#drag.wasOutside = true;
            const nearest = origin.clone().addScaledVector(direction, along).sub(this.center).normalize();
            return nearest.toArray();
        }
        if (this.#drag.wasOutside) {
            this.#drag.isFar = !this.#drag.isFar;
            this.#drag.wasOutside = false;
        }
        const isInside = toCenter.lengthSq() < this.radius ** 2;
        const at = along + (this.#drag.isFar || isInside ? 1 : -1) * Math.sqrt(squared);
        return origin.clone().addScaledVector(direction, at).sub(this.center).normalize().toArray();
    }

    #end() {
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
        for (const element of this.#elements.values()) {
            const direction = normalized(element.light.direction);
            const point = direction.map((value, k) => this.center.getComponent(k) + value * this.radius);
            const {x, y, isInFront} = this.#stage.onCanvas(point);
            element.style.transform = `translate(${x}px, ${y}px)`;
            element.hidden = !isInFront;
            element.classList.toggle('far', this.#isFar(direction));
        }
    }
}
