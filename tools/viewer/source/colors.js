// Colors of particles: by species and by body those of Okabe and Ito, by velocity two scales that color-blind readers
// can follow.

import { Color } from "three";

const OKABE_ITO = ["#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9"]; // solvent first, as in the plots
const CIVIDIS = ["#00306f", "#3b4a6c", "#666970", "#8c8774", "#b5a76a", "#e2ca4f", "#fee838"];
const DIVERGING = ["#0072B2", "#7fb8d8", "#e9e9e9", "#ea9e66", "#D55E00"];
const SOLVENT = "#4f95c6";

export class Coloring {
    constructor(trajectory) {
        this.trajectory = trajectory;
        this.by = "species";
        this.species = trajectory.species.map((_, kind) => new Color(kind ? OKABE_ITO[1 + ((kind - 1) % 5)] : SOLVENT));
        this.bodies = Array.from({ length: 18 }, (_, number) => {
            const color = new Color(OKABE_ITO[number % 6]);
            return color.offsetHSL(0, 0, [0, 0.14, -0.1][Math.floor(number / 6)]);
        });
        this.scales = { speed: CIVIDIS, velocity: DIVERGING };
        this.stops = Object.fromEntries(
            Object.entries(this.scales).map(([name, stops]) => [name, stops.map((stop) => new Color(stop))]),
        );
    }

    // The color of a particle, written into `into`.
    of(frame, particle, into) {
        const kind = this.trajectory.kind[particle];
        if (this.by === "species") return into.copy(this.species[kind]);
        if (this.by === "body") {
            const body = this.trajectory.body[particle];
            return into.copy(body < 0 ? this.species[0] : this.bodies[body % this.bodies.length]);
        }
        const stops = this.stops[this.by];
        const place = this.trajectory.shade(this.by, frame, particle) * (stops.length - 1);
        const below = Math.min(Math.floor(place), stops.length - 2);
        return into.lerpColors(stops[below], stops[below + 1], place - below);
    }

    // What the colors mean, as HTML without anything that a user wrote but the names of species.
    legend() {
        const legend = document.createElement("div");
        if (this.by in this.scales) {
            const { low, high, words } = this.trajectory.shades[this.by];
            const bar = document.createElement("span");
            bar.className = "bar";
            bar.style.background = `linear-gradient(to right, ${this.scales[this.by].join(", ")})`;
            legend.append(`${words}: ${number(low)}`, bar, number(high));
        } else if (this.by === "species") {
            this.trajectory.species.forEach((name, kind) => legend.append(swatch(this.species[kind]), `${name} `));
        } else {
            legend.append("each body has one of 18 colors");
        }
        return legend;
    }
}

function swatch(color) {
    const made = document.createElement("span");
    made.className = "swatch";
    made.style.background = color.getStyle();
    return made;
}

function number(value) {
    return value.toPrecision(2).replace("-", "\u2212");
}
