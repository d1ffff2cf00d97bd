// <relumine-viewer src="folder/">: a scene that `relumine export web` wrote, in light that can be changed.
import {Assets, PageError} from './assets.js';
import {Desk} from './desk.js';
import {brightness, composed, halfNumbers, readEnvironment, shrunk, thumbnail} from './environments.js';
import {Handles} from './handles.js';
import {hdrFile} from './hdr_file.js';
import {skyQuestion} from './highlights.js';
import {LightClient} from './light_client.js';
import {lookOf} from './look.js';
import {Panel, markup} from './panel.js';
import {Stage} from './stage.js';
import {skyPixels} from './sky.js';
import style from './style.css';
import {contributions, drawContributions} from './who.js';

const mostSky = 2048, lightResolution = 128;
const plains = {dark: [[0.055, 0.058, 0.066], [0.13, 0.137, 0.152]], light: [[0.62, 0.64, 0.68], [0.9, 0.91, 0.93]]};

class RelumineViewer extends HTMLElement {
    static observedAttributes = ['theme', 'src'];
    #assets;
    #client;
    #stage;
    #panel;
    #desk;
    #handles;
    #manifest;
    #environments = new Map();
    #look;
    #reads = 0;
    #shownEnvironment;
    #glows = [];
    #shownGlow;
    #pin;
    #watch = new AbortController();

    /** Resolves when the first light is seen. */
    ready = new Promise((resolve, reject) => { this.readied = {resolve, reject}; });

    connectedCallback() {
        if (this.shadowRoot)
            return;
        this.attachShadow({mode: 'open'}).innerHTML = `<style>${style}</style>${markup}`;
        this.ready.catch(() => {});
        this.#panel = new Panel(this.shadowRoot, this.#controls());
        this.#applyTheme();
        if (this.clientWidth < 700)
            this.#togglePanel(false);
        this.#load().catch((error) => this.#fail(error));
    }

    disconnectedCallback() {
        this.#watch.abort();
        this.#client?.end();
        this.#stage?.end();
    }

    attributeChangedCallback(name) {
        if (name === 'theme' && this.#desk)
            this.#showLook();
    }

    // --- for programs ---

    get state() { return structuredClone(this.#desk.state); }
    /** Members that are left out stay as they are. */
    set state(next) { this.#desk.set(next); }
    get isSettled() { return this.#client.isSettled && this.settleTimer === undefined && this.#stage?.isAtRest === true; }
    /** Radiance of the scene's vertices for albedo 1, 3 numbers each. */
    get radiance() { return this.lastRadiance.slice(); }
    /** A step of a drag of a light, or of a turn; setting `state` ends it. */
    drag(light) { this.#desk.setLight(light, true); }
    turn(degrees) { this.#desk.set({turn: degrees}, true); }
    undo() { this.#desk.undo(); }
    redo() { this.#desk.redo(); }
    addLight(type = 'disc', direction = this.#keyDirection()) { return this.#desk.addLight(type, direction); }
    /** The environment with its turn and its lights, as a Radiance file. */
    environmentFile() { return hdrFile(this.#composed()); }
    async addEnvironment(name, bytes) { await this.#addFile(new File([bytes], name)); }

    // --- loading ---

    async #load() {
        this.#assets = new Assets(this.getAttribute('src') ?? '.');
        if (typeof WebAssembly === 'undefined')
            throw new PageError('This browser cannot run the scene\'s light: it needs WebAssembly.');
        this.#client = new LightClient({
            onRadiance: (answer) => this.#takeRadiance(answer), onError: (error) => this.#panel.message(error.message),
            turn: () => this.#stage.pace.turn(),
        });
        const wasm = this.#assets.bytes('relumine.wasm.gz');
        wasm.catch(() => {});
        this.#manifest = await this.#assets.json('scene.json');
        const manifest = this.#manifest;
        if (manifest.version !== 1)
            throw new PageError('scene.json is of another version of this page.');
        const first = manifest.environments[0];
        const picture = this.#environment(first.id);
        picture.catch(() => {});
        const numbers = async (file) => file && halfNumbers(await this.#assets.bytes(file));
        const lamps = Promise.all(manifest.lamps.map(async ({file, bounced}) => (
            {direct: await numbers(file), bounced: await numbers(bounced)})));
        lamps.catch(() => {});
        const glows = Promise.all(manifest.lamps.map(({glow}) => numbers(glow)));
        glows.catch(() => {});
        const opened = await this.#client.ask('open', {
            wasm: await wasm, scene: await this.#assets.bytes(manifest.scene), lamps: await lamps,
        }).catch((error) => { throw new PageError(`The scene cannot be opened: ${error.message}`); });
        this.info = opened.info;
        this.#look = await lookOf(this.#assets, manifest, opened);
        this.#makeStage();
        if (this.#look.hasHighlights) {
            const {cells, ...question} = skyQuestion(this.#look.numShining);
            const {parts, open} = await this.#client.ask('seen', question);
            this.#stage.setSeen({parts, cells, open: this.#look.gathered(open, 1)});
            this.#glows = (await glows).map((glow) => glow && this.#look.gathered(glow));
        }
        await picture;
        this.#makeDesk(first.id, opened.info.hasBounces);
        this.#panel.setTones(manifest.tone.names);
        this.#panel.setScene({hasBounces: opened.info.hasBounces, lamps: manifest.lamps});
        this.find('h1').textContent = manifest.title;
        this.#listEnvironments();
        await this.#useEnvironment(first.id);
    }

    find(selector) { return this.shadowRoot.querySelector(selector); }

    #makeStage() {
        const canvas = this.find('canvas');
        try {
            this.#stage = new Stage(canvas, this.#manifest.tone.source);
        } catch {
            throw new PageError('This browser cannot draw the scene: it needs WebGL 2.');
        }
        this.#stage.setMesh(this.#look);
        const fit = () => {
            this.#stage.resize(this.clientWidth, this.clientHeight);
            this.#leaveFree();
        };
        new ResizeObserver(fit).observe(this);
        new ResizeObserver(() => this.#leaveFree()).observe(this.find('footer'));
        fit();
        this.#stage.setCamera({...this.#manifest.camera, radius: this.#manifest.subject.radius});
        this.#handles = new Handles(this.find('.handles'), this.#stage, {
                change: (light, isStep) => (light ? this.#desk.setLight(light, isStep) : this.#desk.set({})),
                select: (id) => this.#select(id), selected: () => this.#desk.selected,
                remove: (id) => this.#desk.removeLight(id),
            });
        this.#stage.onFrame = () => {
            this.#handles.place();
            this.#placePin();
        };
        this.#listen(canvas);
    }

    #makeDesk(environment, hasBounces) {
        const first = {
            environment, turn: 0, exposure: 0, tone: 0, background: 'environment', lights: [], bounces: hasBounces,
            lamps: this.#manifest.lamps.map(() => 1),
        };
        this.#desk = new Desk(first, {changed: (state, isStep) => this.#changed(state, isStep)});
    }

    #fail(error) {
        console.error(error);
        this.#panel.fail(error instanceof PageError ? error.message : `This page stopped: ${error.message ?? error}.`);
        this.readied.reject(error);
    }

    // --- environments ---

    /** Reads an environment once. */
    #environment(id) {
        if (!this.#environments.has(id)) {
            const known = this.#manifest.environments.find((environment) => environment.id === id);
            const read = (async () => {
                const picture = readEnvironment(known.file, await this.#assets.bytes(known.file));
                return {...known, picture: shrunk(picture, mostSky), thumb: await this.#assets.url(known.thumb, 'image/png')};
            })();
            this.#environments.set(id, read);
            read.catch(() => this.#environments.delete(id));
        }
        return this.#environments.get(id);
    }

    async #listEnvironments() {
        const list = await Promise.all(this.#manifest.environments.map(async (environment) => ({
            ...environment, thumb: environment.thumbData ?? await this.#assets.url(environment.thumb, 'image/png'),
        })));
        this.#panel.setEnvironments(list, this.#desk.state.environment);
    }

    async #useEnvironment(id) {
        const read = ++this.#reads;
        const environment = await this.#environment(id);
        if (read !== this.#reads)
            return;
        const {picture} = environment;
        this.current = environment;
        this.#shownEnvironment = id;
        this.isExposed = environment.exposure !== undefined;
        await this.#client.ask('environment', {latLong: picture.rgb, width: picture.width, height: picture.height, resolution: lightResolution});
        this.#stage.setSky(environment.sky ??= skyPixels(picture));
        if (this.#look.hasHighlights)
            this.#stage.setMirrored(picture);
        this.find('.error-line').textContent = this.#errorLine(environment);
        // At once, then exactly.
        this.#relight(true);
        this.#showLook();
    }

    #errorLine({verified}) {
        const {leftOut, bouncesError} = this.#manifest;
        const bounces = bouncesError > 0 ? ` Light between surfaces is thinned, within ${this.#percent(bouncesError)} of all light.` : '';
        const left = leftOut.length > 0 ? ` Left out: ${leftOut.join(', ')}.` : '';
        if (!verified)
            return `Light not verified.${bounces}${left}`;
        return `Light within ${this.#percent(verified.relativeL2)} of exact integration here.${bounces}${left}`;
    }

    #percent(value) { return `${Number((100 * value).toPrecision(2))} %`; }

    async #addFile(file) {
        try {
            const picture = shrunk(readEnvironment(file.name, new Uint8Array(await file.arrayBuffer())), mostSky);
            const id = `file-${this.#environments.size}-${file.name}`;
            const environment = {id, name: file.name.replace(/\.[^.]*$/, ''), picture, thumbData: thumbnail(picture)};
            this.#environments.set(id, Promise.resolve(environment));
            this.#manifest.environments.push(environment);
            this.#desk.set({environment: id});
            await this.#listEnvironments();
        } catch (error) {
            this.#panel.message(error.message);
        }
    }

    #composed() {
        const {state} = this.#desk;
        return composed(this.current.picture, state.turn, this.#lights());
    }

    // --- light ---

    /** A light of no stops gives a surface that faces it as much as the environment gives a floor. */
    #lights() {
        const {lights} = this.#desk.state;
        this.current.brightness ??= Math.PI * brightness(this.current.picture);
        return lights.map(({stops, ...light}) => ({...light, power: this.current.brightness * 2 ** stops}));
    }

    #relight(isStep) {
        const {turn, bounces, lamps} = this.#desk.state;
        this.#client.want({turn, bounces, lamps, lights: this.#lights()}, isStep);
        clearTimeout(this.settleTimer);
        this.settleTimer = undefined;
        if (isStep)
            this.#settle();
    }

    /** What steps leave out is found when they end: when the last one has been seen for a while. */
    #settle() {
        this.settleTimer = setTimeout(() => {
            this.settleTimer = undefined;
            if (this.#client.isSettled && !this.#stage.pace.isBusy)
                this.#relight(false);
            else
                this.#settle();
        }, 150);
    }

    /** Highlights of the state; its other light is the worker's. */
    #showHighlights() {
        if (!this.#look.hasHighlights || !this.current)
            return;
        this.#stage.setLights(this.#lights());
        const {lamps} = this.#desk.state;
        if (this.#glows.every((glow) => glow === undefined) || JSON.stringify(lamps) === this.#shownGlow)
            return;
        this.#shownGlow = JSON.stringify(lamps);
        const sum = new Float32Array(this.#look.albedo.length);
        this.#glows.forEach((glow, k) => glow?.forEach((value, i) => { sum[i] += lamps[k] * value; }));
        this.#stage.setGlow(sum);
    }

    #takeRadiance({radiance, ...times}) {
        this.times = times;
        this.lastRadiance = radiance;
        const {receivers} = this.#look;
        if (receivers) {
            const gathered = this.spareGathered ?? new Float32Array(3 * receivers.length);
            for (let i = 0; i < receivers.length; ++i)
                for (let k = 0; k < 3; ++k)
                    gathered[3 * i + k] = radiance[3 * receivers[i] + k];
            this.spareGathered = this.#stage.setRadiance(gathered);
        } else {
            this.#stage.setRadiance(radiance.slice());
        }
        if (!this.isExposed)
            this.#expose(radiance, times.isStep);
        if (this.find('.loading').className === 'loading') {
            this.find('.loading').className = 'loading done';
            this.#stage.pace.first.then(() => { this.firstMilliseconds = performance.now(); });
            this.readied.resolve(this);
            this.dispatchEvent(new Event('ready'));
        }
        this.dispatchEvent(new Event('light'));
    }

    /** What is bright on the mesh comes out a little below white. */
    #expose(radiance, isStep) {
        const {shownAlbedo: albedo, receivers} = this.#look;
        const values = [];
        const count = albedo.length / 3, step = Math.max(1, Math.floor(count / 20000));
        for (let i = 0; i < count; i += step) {
            const from = 3 * (receivers ? receivers[i] : i);
            values.push(Math.max(...[0, 1, 2].map((k) => albedo[3 * i + k] * radiance[from + k])));
        }
        values.sort((a, b) => a - b);
        const bright = values[Math.floor(0.95 * (values.length - 1))];
        this.current.exposure = bright > 0 ? Math.log2(0.72 / bright) : 0;
        this.isExposed = !isStep;
        this.#showLook();
    }

    // --- the desk ---

    #changed(state, isStep) {
        if (state.environment !== this.#shownEnvironment)
            this.#useEnvironment(state.environment).catch((error) => this.#panel.message(error.message));
        else
            this.#relight(isStep);
        this.#showLook();
    }

    #showLook() {
        const {state} = this.#desk;
        this.#applyTheme();
        this.#stage.setLook({
            exposure: (this.current?.exposure ?? 0) + state.exposure, curve: state.tone, turn: state.turn,
            isPlain: state.background === 'plain', plain: plains[this.getAttribute('theme') ?? 'dark'],
        });
        this.#showHighlights();
        this.#handles.set(state.lights);
        this.#panel.show(state, {selected: this.#desk.selected, canUndo: this.#desk.history.canUndo, canRedo: this.#desk.history.canRedo});
        this.#hidePin(state);
    }

    #select(id) {
        if (this.#desk.selected === id)
            return;
        this.#desk.selected = id;
        this.#showLook();
    }

    #controls() {
        return {
            set: (name, value, isStep) => this.#set(name, value, isStep),
            action: (name) => this.#action(name),
            add: (type) => this.addLight(type),
            select: (id) => this.#select(id),
            remove: (id) => this.#desk.removeLight(id),
            toggle: (id) => this.#desk.setLight({...this.#desk.light(id), on: !this.#desk.light(id).on}),
            environment: (id) => this.#desk.set({environment: id}),
            background: (background) => this.#desk.set({background}),
        };
    }

    #set(name, value, isStep) {
        const [group, member] = name.split('.');
        const {state} = this.#desk;
        if (group === 'light')
            this.#desk.setLight({...this.#desk.light(this.#desk.selected), [member === 'power' ? 'stops' : member]: value}, isStep);
        else if (group === 'lamp')
            this.#desk.set({lamps: state.lamps.map((gain, i) => (i === Number(member) ? value : gain))}, isStep);
        else
            this.#desk.set({[name]: value}, isStep);
    }

    #action(name) {
        const actions = {
            undo: () => this.#desk.undo(), redo: () => this.#desk.redo(), save: () => this.#save(),
            home: () => this.#stage.setCamera(this.#stage.home), panel: () => this.#togglePanel(),
            theme: () => this.setAttribute('theme', this.getAttribute('theme') === 'light' ? 'dark' : 'light'),
            close: () => this.#closeWho(), 'close-message': () => this.#panel.message(undefined), open: () => this.#openFile(),
        };
        actions[name]();
    }

    #applyTheme() {
        if (!this.hasAttribute('theme'))
            this.setAttribute('theme', matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark');
    }

    /** The picture's middle is that of what the controls leave free. */
    #leaveFree() {
        const isNarrow = this.clientWidth < 700, isOpen = !this.find('aside').classList.contains('closed');
        const footer = this.find('footer').offsetHeight - 30, right = !isNarrow && isOpen ? 288 : 0;
        this.find('footer').style.setProperty('--aside', `${right}px`);
        this.#stage?.setFree({
            right, bottom: footer + (isNarrow && isOpen ? this.find('aside').offsetHeight : 0),
        });
    }

    #togglePanel(isOpen = this.find('aside').classList.contains('closed')) {
        this.find('aside').classList.toggle('closed', !isOpen);
        this.find('[data-do=panel]').setAttribute('aria-expanded', isOpen);
        this.#leaveFree();
    }

    /** Where a photographer puts the first light: beside the camera, above it; the next ones around. */
    #keyDirection() {
        const turns = [-40, 55, 160, -120, 100];
        const azimuth = this.#stage.azimuth + turns[this.#desk.state.lights.length % turns.length] * Math.PI / 180;
        const elevation = 0.65;
        return [Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)];
    }

    #save() {
        const link = document.createElement('a');
        link.href = URL.createObjectURL(new Blob([this.environmentFile()], {type: 'image/vnd.radiance'}));
        link.download = `${this.current.name}-lit.hdr`;
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    }

    #openFile() {
        const input = document.createElement('input');
        input.type = 'file';
        input.accept = '.hdr,.exr';
        input.onchange = () => input.files[0] && this.#addFile(input.files[0]);
        input.click();
    }

    // --- pointer and keys ---

    #listen(canvas) {
        const {signal} = this.#watch;
        let down;
        canvas.addEventListener('pointerdown', (event) => { down = {x: event.clientX, y: event.clientY, time: event.timeStamp}; });
        canvas.addEventListener('pointerup', (event) => {
            const isClick = down && event.timeStamp - down.time < 400 &&
                Math.hypot(event.clientX - down.x, event.clientY - down.y) < 5;
            if (isClick && event.button === 0) {
                const box = canvas.getBoundingClientRect();
                this.ask(event.clientX - box.left, event.clientY - box.top);
            }
        });
        this.addEventListener('keydown', (event) => this.#key(event));
        let depth = 0;
        this.addEventListener('dragenter', (event) => {
            event.preventDefault();
            ++depth;
            this.find('.drop').hidden = false;
        });
        this.addEventListener('dragover', (event) => event.preventDefault());
        this.addEventListener('dragleave', () => { this.find('.drop').hidden = --depth <= 0; });
        this.addEventListener('drop', (event) => {
            event.preventDefault();
            depth = 0;
            this.find('.drop').hidden = true;
            if (event.dataTransfer.files[0])
                this.#addFile(event.dataTransfer.files[0]);
        });
        matchMedia('(prefers-color-scheme: light)').addEventListener('change', ({matches}) =>
            this.setAttribute('theme', matches ? 'light' : 'dark'), {signal});
    }

    #key(event) {
        const isCommand = event.ctrlKey || event.metaKey;
        if (isCommand && event.key.toLowerCase() === 'z')
            (event.shiftKey ? this.redo() : this.undo());
        else if (isCommand && event.key.toLowerCase() === 'y')
            this.redo();
        else if (event.key === 'Escape')
            this.#closeWho();
        else if (event.key === 'Home')
            this.#action('home');
        else if (!isCommand && this.shadowRoot.activeElement === this.find('canvas') && event.key.startsWith('Arrow'))
            this.#stage.orbit({ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key]);
        else
            return;
        event.preventDefault();
    }

    // --- what lights a point ---

    /** Asks what lights the point under a place of the picture. */
    async ask(x, y) {
        const hit = this.#stage.hit(x, y);
        if (!hit)
            return this.#closeWho();
        const receiver = this.#look.receivers ? this.#look.receivers[hit.vertex] : hit.vertex;
        const found = contributions(await this.#client.ask('contributions', {receiver}), this.#composed(), this.#lights(),
            this.#stage.azimuth);
        drawContributions(this.find('.who canvas'), found);
        const list = this.find('.who ul');
        list.innerHTML = '';
        for (const {name, share} of found.shares) {
            const item = document.createElement('li');
            item.innerHTML = '<span></span><span></span>';
            item.children[0].textContent = name;
            item.children[1].textContent = `${Math.round(100 * share)} %`;
            list.append(item);
        }
        this.find('.who').hidden = false;
        this.#togglePanel(true);
        this.find('.who').scrollIntoView({block: 'nearest'});
        this.#pin = {point: hit.point.toArray(), state: JSON.stringify(this.#desk.state)};
        this.#placePin();
        this.lastAnswer = {receiver, total: found.total, shares: found.shares};
        return this.lastAnswer;
    }

    #placePin() {
        const pin = this.find('.pin');
        pin.hidden = this.#pin === undefined;
        if (!this.#pin)
            return;
        const {x, y} = this.#stage.onCanvas(this.#pin.point);
        pin.style.transform = `translate(${x}px, ${y}px)`;
    }

    /** Other light makes the answer an old one. */
    #hidePin(state) {
        if (this.#pin && this.#pin.state !== JSON.stringify(state))
            this.#closeWho();
    }

    #closeWho() {
        this.#pin = undefined;
        this.find('.who').hidden = true;
        this.#placePin();
    }
}

customElements.define('relumine-viewer', RelumineViewer);
