// The state of the page's light and its changes: what undo goes back to.
import {History} from './history.js';

const firstPower = 0;
let nextLight = 1;

export class Desk {
    history = new History();
    selected;

    /** `on`: {changed(state, isStep)} */
    constructor(state, on) {
        this.state = state;
        this.on = on;
        this.history.keep(state);
    }

    /** Changes members of the state; a step is a part of a drag, after which set({}) ends it. */
    set(members, isStep = false) {
        this.state = {...this.state, ...members};
        if (!isStep)
            this.history.keep(this.state);
        this.on.changed(this.state, isStep);
    }

    light(id) { return this.state.lights.find((light) => light.id === id); }

    setLight(light, isStep) {
        this.set({lights: this.state.lights.map((old) => (old.id === light.id ? light : old))}, isStep);
    }

    /** `power`: of a light of no stops, irradiance. */
    addLight(type, direction) {
        const id = `light-${nextLight++}`;
        const names = {disc: 'Disc', box: 'Soft box'};
        let number = 1;
        const name = () => (number === 1 ? names[type] : `${names[type]} ${number}`);
        while (this.state.lights.some((light) => light.name === name()))
            ++number;
        const light = {
            id, name: name(), type, direction, on: true, stops: firstPower, kelvin: 5600,
            size: type === 'disc' ? 14 : 36, aspect: 1.5, softness: type === 'disc' ? 0.3 : 0.15,
        };
        this.selected = id;
        this.set({lights: [...this.state.lights, light]});
        return light;
    }

    removeLight(id) {
        if (this.selected === id)
            this.selected = undefined;
        this.set({lights: this.state.lights.filter((light) => light.id !== id)});
    }

    undo() { this.#go(this.history.undo()); }
    redo() { this.#go(this.history.redo()); }

    #go(state) {
        if (state === undefined)
            return;
        this.state = state;
        if (this.light(this.selected) === undefined)
            this.selected = undefined;
        this.on.changed(state, false);
    }
}
