// What report/viewer.py wrote: positions as uint16 in the box's own coordinates, and velocities as a byte.

function bytes(text) {
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

export class Trajectory {
    constructor(description) {
        Object.assign(this, description); // dimension, size, tilts, times, steps, species, bodies, ranges ...
        this.frames = this.times.length;
        this.kind = bytes(description.kind); // of each particle: 0 solvent, k the k-th species of bodies
        this.body = new Int32Array(bytes(description.body).buffer); // of each particle, -1 for solvent
        this.count = this.kind.length;
        this.solvent = this.kind.indexOf(1) < 0 && !this.kind.some((kind) => kind) ? this.count : this.kind.findIndex((kind) => kind);
        this.place = new Uint16Array(bytes(description.place).buffer);
        this.shades = Object.fromEntries(
            Object.entries(description.shades).map(([name, shade]) => [name, { ...shade, value: bytes(shade.value) }]),
        );
    }

    // Position of a particle about the middle of the box; `place` covers twice the box, since bodies are drawn whole.
    position(frame, particle, into) {
        const [width, height, depth] = this.size;
        const at = (frame * this.count + particle) * this.dimension;
        const along = (axis) => (this.place[at + axis] / 65535 - 0.5) * 2;
        const y = along(1) * height;
        return into.set(along(0) * width + this.tilts[frame] * y, y, this.dimension === 3 ? along(2) * depth : 0);
    }

    // From 0 to 1 between the ends of a shade's range.
    shade(name, frame, particle) {
        return this.shades[name].value[frame * this.count + particle] / 255;
    }
}
