// The files of an exported scene: beside the page, or within it where it is a single file.

export class PageError extends Error {}

async function unzipped(bytes) {
    if (typeof DecompressionStream === 'undefined')
        throw new PageError('This browser is too old for the scene: it cannot unpack gzip (Chrome 80, Firefox 113, ' +
                            'Safari 16.4).');
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

function decoded(text) {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i)
        bytes[i] = binary.charCodeAt(i);
    return bytes;
}

export class Assets {
    constructor(base) {
        this.base = new URL(base.endsWith('/') ? base : `${base}/`, document.baseURI);
        this.within = (name) => document.querySelector(`script[data-relumine-file="${CSS.escape(name)}"]`);
    }

    async bytes(name) {
        const bytes = await this.#stored(name);
        return name.endsWith('.gz') ? unzipped(bytes) : bytes;
    }

    async #stored(name) {
        const element = this.within(name);
        if (element)
            return decoded(element.textContent);
        const url = new URL(name, this.base);
        if (url.protocol === 'file:')
            throw new PageError('A browser does not let a page read other files of this computer. Put the folder on a ' +
                                'web server, or export one file: -o page.html.');
        let response;
        try {
            response = await fetch(url);
        } catch (error) {
            throw new PageError(`${name} cannot be loaded: ${error.message}.`);
        }
        if (!response.ok)
            throw new PageError(`${name} cannot be loaded: ${response.status} ${response.statusText}.`);
        return new Uint8Array(await response.arrayBuffer());
    }

    async json(name) {
        const text = new TextDecoder().decode(await this.bytes(name));
        try {
            return JSON.parse(text);
        } catch {
            throw new PageError(`${name} is damaged.`);
        }
    }

    /** A URL for an <img>. */
    async url(name, type) {
        if (!this.within(name))
            return new URL(name, this.base).href;
        return URL.createObjectURL(new Blob([await this.bytes(name)], {type}));
    }
}
