// The controls around the picture. They show a state and say what is to change; they keep none.

const icons = {
    undo: 'M9 14 4 9l5-5M4 9h10a6 6 0 0 1 0 12h-3', redo: 'm15 14 5-5-5-5M20 9H10a6 6 0 0 0 0 12h3',
    save: 'M12 3v12m0 0-5-5m5 5 5-5M4 20h16', theme: 'M12 3a9 9 0 1 0 9 9 7 7 0 0 1-9-9Z',
    home: 'M4 4h5M4 4v5m16-5h-5m5 0v5M4 20h5m-5 0v-5m16 5h-5m5 0v-5', panel: 'M4 7h10m4 0h2M4 17h2m4 0h10M14 4v6M8 14v6',
    close: 'M6 6l12 12M18 6 6 18', disc: 'M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16Z', box: 'M4 7h16v10H4Z',
    trash: 'M5 7h14M10 7V4h4v3m-8 0 1 13h10l1-13', plus: 'M12 5v14M5 12h14',
    eye: 'M2 12s4-7 10-7 10 7 10 7-4 7-10 7-10-7-10-7Zm10-3a3 3 0 1 0 0 6 3 3 0 0 0 0-6Z',
};
export const icon = (name) => `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${icons[name]}"/></svg>`;
const button = (name, label, extra = '') =>
    `<button type="button" class="icon" data-do="${name}" aria-label="${label}" title="${label}" ${extra}>${icon(name)}</button>`;
const slider = (name, label, min, max, step) => `
    <label class="slider"><span>${label}</span><output data-of="${name}"></output>
    <input type="range" data-set="${name}" min="${min}" max="${max}" step="${step}" aria-label="${label}"></label>`;

export const markup = `
<canvas tabindex="0" aria-label="The lit scene. Drag to turn it, scroll or pinch to come closer, click to ask what lights a point."></canvas>
<div class="handles"></div>
<div class="pin" hidden></div>
<header>
    <h1></h1>
    <nav>${button('undo', 'Undo (Ctrl Z)')}${button('redo', 'Redo (Ctrl Shift Z)')}${button('home', 'First view (Home)')}${button('save', 'Save the environment with its lights, .hdr')}${button('theme', 'Dark or light')}${button('panel', 'Light controls', 'aria-expanded="true"')}</nav>
</header>
<aside aria-label="Light controls">
    <section>
        <h2>Environment</h2>
        ${slider('turn', 'Turn', 0, 360, 1)}
        ${slider('exposure', 'Exposure', -4, 4, 0.05)}
        <label class="choice"><span>Tone</span><select data-set="tone"></select></label>
        <div class="choice"><span>Background</span><div class="segments" role="group" aria-label="Background">
            <button type="button" data-background="environment">Photo</button><button type="button" data-background="plain">Plain</button></div></div>
    </section>
    <section>
        <h2>Lights <span class="add"><button type="button" data-add="disc">${icon('plus')} Disc</button><button type="button" data-add="box">${icon('plus')} Soft box</button></span></h2>
        <ul class="lights"></ul>
        <p class="hint none">Add a light, then drag it around the scene.</p>
        <div class="light" hidden>
            ${slider('light.power', 'Brightness', -4, 4, 0.05)}
            ${slider('light.size', 'Size', 2, 90, 0.5)}
            ${slider('light.softness', 'Soft edge', 0, 1, 0.01)}
            ${slider('light.kelvin', 'Colour', 1800, 12000, 50)}
        </div>
    </section>
    <section class="of-scene" hidden>
        <h2>Scene</h2>
        <label class="switch bounces" hidden><span>Light between surfaces</span><input type="checkbox" data-set="bounces" role="switch"></label>
        <div class="lamps"></div>
    </section>
    <section class="who" hidden>
        <h2>What lights this point ${button('close', 'Close')}</h2>
        <canvas width="256" height="128" aria-label="The environment; what is bright here lights the point."></canvas>
        <ul></ul>
    </section>
</aside>
<footer>
    <div class="strip" role="listbox" aria-label="Environments"></div>
    <p class="error-line"></p>
</footer>
<div class="drop" hidden><p>Drop a .hdr or .exr environment</p></div>
<div class="message" role="alert" hidden><p></p><button type="button" data-do="close-message">OK</button></div>
<div class="loading"><div class="ring"></div><p>Loading</p></div>
`;

const shown = {
    turn: (value) => `${Math.round(value)}°`,
    exposure: (value) => `${value > 0 ? '+' : ''}${value.toFixed(2)}`,
    'light.power': (value) => `${value > 0 ? '+' : ''}${value.toFixed(2)}`,
    'light.size': (value) => `${value.toFixed(0)}°`,
    'light.softness': (value) => `${Math.round(100 * value)} %`,
    'light.kelvin': (value) => `${Math.round(value)} K`,
};

export class Panel {
    #root;

    /** `on`: {set(name, value, isStep), action(name), add(type), select(id), remove(id), toggle(id), environment(id), background(kind)} */
    constructor(root, on) {
        this.#root = root;
        this.on = on;
        root.addEventListener('input', ({target}) => this.#input(target, true));
        root.addEventListener('change', ({target}) => this.#input(target, false));
        root.addEventListener('click', (event) => this.#click(event));
        root.addEventListener('dblclick', ({target}) => {
            const input = target.closest?.('.slider')?.querySelector('input');
            if (input && input.dataset.set in {turn: 0, exposure: 0})
                on.set(input.dataset.set, 0, false);
        });
    }

    find(selector) { return this.#root.querySelector(selector); }

    #input(target, isStep) {
        const name = target.dataset.set;
        if (name === undefined)
            return;
        if (target.type === 'checkbox')
            isStep || this.on.set(name, target.checked, false);
        else if (target.tagName === 'SELECT')
            isStep || this.on.set(name, Number(target.value), false);
        else
            this.on.set(name, Number(target.value), isStep);
    }

    #click({target}) {
        const found = (name) => target.closest?.(`[data-${name}]`)?.dataset;
        if (found('do')) this.on.action(found('do').do);
        else if (found('add')) this.on.add(found('add').add);
        else if (found('background')) this.on.background(found('background').background);
        else if (found('environment')) this.on.environment(found('environment').environment);
        else if (found('remove')) this.on.remove(found('remove').remove);
        else if (found('toggle')) this.on.toggle(found('toggle').toggle);
        else if (found('select')) this.on.select(found('select').select);
    }

    setTones(names) {
        const titles = {neutral: 'Neutral', agx: 'AgX', aces: 'ACES', none: 'Clipped'};
        this.find('[data-set=tone]').innerHTML = names.map((name, i) => `<option value="${i}">${titles[name] ?? name}</option>`).join('');
    }

    setEnvironments(list, current) {
        const strip = this.find('.strip');
        strip.innerHTML = '';
        for (const {id, name, thumb} of list) {
            const tile = document.createElement('button');
            tile.type = 'button';
            tile.dataset.environment = id;
            tile.setAttribute('role', 'option');
            tile.setAttribute('aria-selected', id === current);
            tile.title = name;
            tile.innerHTML = '<img alt=""><span></span>';
            tile.querySelector('img').src = thumb;
            tile.querySelector('span').textContent = name;
            strip.append(tile);
        }
        const add = document.createElement('button');
        add.type = 'button';
        add.className = 'open';
        add.dataset.do = 'open';
        add.title = 'Open a .hdr or .exr environment, or drop one on the page';
        add.innerHTML = `${icon('plus')}<span>.hdr, .exr</span>`;
        strip.append(add);
        strip.querySelector('[aria-selected=true]')?.scrollIntoView({block: 'nearest', inline: 'nearest'});
    }

    setScene({hasBounces, lamps}) {
        this.find('.bounces').hidden = !hasBounces;
        this.find('.of-scene').hidden = !hasBounces && lamps.length === 0;
        this.find('.lamps').innerHTML = lamps.map((_, i) => slider(`lamp.${i}`, '', 0, 3, 0.02)).join('');
        lamps.forEach(({name}, i) => { this.find(`[data-set="lamp.${i}"]`).parentElement.querySelector('span').textContent = name; });
    }

    #value(name, value) {
        const input = this.find(`[data-set="${name}"]`);
        if (this.#root.activeElement !== input || Number(input.value) !== value)
            input.value = value;
        input.style.setProperty('--part', `${100 * (input.value - input.min) / (input.max - input.min)}%`);
        this.find(`[data-of="${name}"]`).textContent = (shown[name] ?? ((x) => `${Math.round(100 * x)} %`))(value);
    }

    show(state, {selected, canUndo, canRedo}) {
        this.#value('turn', state.turn);
        this.#value('exposure', state.exposure);
        this.find('[data-set=tone]').value = state.tone;
        this.find('[data-set=bounces]').checked = state.bounces;
        state.lamps.forEach((gain, i) => this.#value(`lamp.${i}`, gain));
        for (const tile of this.#root.querySelectorAll('[data-background]'))
            tile.setAttribute('aria-pressed', tile.dataset.background === state.background);
        for (const tile of this.#root.querySelectorAll('[data-environment]'))
            tile.setAttribute('aria-selected', tile.dataset.environment === state.environment);
        this.find('[data-do=undo]').disabled = !canUndo;
        this.find('[data-do=redo]').disabled = !canRedo;
        this.#lights(state.lights, selected);
    }

    #lights(lights, selected) {
        const list = this.find('.lights');
        const key = JSON.stringify([lights.map(({id, name, type, on}) => [id, name, type, on]), selected]);
        if (list.dataset.key !== key) {
            list.dataset.key = key;
            list.innerHTML = lights.map(({id, name, type, on}) => `
                <li class="${id === selected ? 'selected' : ''} ${on ? '' : 'off'}"><button type="button" data-select="${id}">${icon(type)}<span>${name}</span></button>
                <button type="button" class="icon" data-toggle="${id}" aria-pressed="${on}" aria-label="${name} on" title="On or off">${icon('eye')}</button>
                <button type="button" class="icon" data-remove="${id}" aria-label="Remove ${name}" title="Remove">${icon('trash')}</button></li>`).join('');
        }
        this.find('.hint.none').hidden = lights.length > 0;
        const light = lights.find(({id}) => id === selected);
        this.find('.light').hidden = light === undefined;
        if (light) {
            this.#value('light.power', light.stops);
            for (const name of ['size', 'softness', 'kelvin'])
                this.#value(`light.${name}`, light[name]);
        }
    }

    message(text) {
        this.find('.message').hidden = text === undefined;
        this.find('.message p').textContent = text ?? '';
    }

    fail(text) {
        this.find('.loading').className = 'loading failed';
        this.find('.loading p').textContent = text;
        this.find('.loading').hidden = false;
    }
}
