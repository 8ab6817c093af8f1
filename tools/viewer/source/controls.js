// The buttons beneath the view, and the keys: space plays, arrows go from frame to frame.

export class Controls {
    constructor(element, viewer) {
        this.viewer = viewer;
        const find = (name) => element.querySelector(`[data-control="${name}"]`);
        [this.play, this.slider, this.color, this.legend, this.told] = ["play", "frame", "color", "legend", "told"].map(find);
        const only = viewer.trajectory.frames < 2;
        for (const each of [this.play, this.slider, find("previous"), find("next")]) each.disabled = only;
        this.slider.max = viewer.trajectory.frames - 1;
        this.play.addEventListener("click", () => viewer.play());
        find("previous").addEventListener("click", () => this.#step(-1));
        find("next").addEventListener("click", () => this.#step(1));
        find("reset").addEventListener("click", () => viewer.reset());
        this.slider.addEventListener("input", () => this.#step(this.slider.valueAsNumber - viewer.frame));
        this.color.addEventListener("change", () => viewer.colorBy(this.color.value));
        for (const name of ["solvent", "box"]) {
            const shown = find(name);
            const object = name === "solvent" ? viewer.particles.solvent : viewer.box.object;
            shown.addEventListener("change", () => {
                object.visible = shown.checked;
                viewer.draw();
            });
        }
        viewer.canvas.addEventListener("keydown", (event) => this.#key(event));
    }

    #key(event) {
        const does = { ArrowLeft: () => this.#step(-1), ArrowRight: () => this.#step(1), " ": () => this.viewer.play() };
        if (event.key in does) {
            event.preventDefault();
            does[event.key]();
        }
    }

    #step(by) {
        this.viewer.play(false);
        this.viewer.show(this.viewer.frame + by);
    }

    update() {
        const { frame, playing, trajectory } = this.viewer;
        this.slider.value = frame;
        this.play.textContent = playing ? "Pause" : "Play";
        this.play.setAttribute("aria-pressed", playing);
        const told = `frame ${frame + 1} of ${trajectory.frames}, time ${trajectory.times[frame].toPrecision(4)}`;
        this.told.textContent = told;
        this.slider.setAttribute("aria-valuetext", told);
        this.legend.replaceChildren(this.viewer.coloring.legend());
    }
}
