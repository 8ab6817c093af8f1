// The sheared box: its edges follow the tilt, and words say what its axes are.

import { BufferAttribute, BufferGeometry, CanvasTexture, Group, LineBasicMaterial, LineSegments, Sprite, SpriteMaterial } from "three";

const WORDS = ["x flow", "y gradient", "z vorticity"];

export class Box {
    constructor(trajectory) {
        this.trajectory = trajectory;
        const corners = trajectory.dimension === 3 ? 8 : 4;
        this.edges = [];
        for (let corner = 0; corner < corners; corner++) {
            for (let bit = 1; bit < corners; bit *= 2) {
                if (!(corner & bit)) this.edges.push(corner, corner | bit);
            }
        }
        this.place = new BufferAttribute(new Float32Array(3 * this.edges.length), 3);
        const geometry = new BufferGeometry().setAttribute("position", this.place);
        this.lines = new LineSegments(geometry, new LineBasicMaterial());
        this.lines.frustumCulled = false;
        this.words = WORDS.slice(0, trajectory.dimension).map(() => new Sprite(new SpriteMaterial({ depthTest: false })));
        this.object = new Group().add(this.lines, ...this.words);
    }

    #corner(number, tilt) {
        const [width, height, depth] = this.trajectory.size;
        const [a, b, c] = [1, 2, 4].map((bit) => (number & bit ? 0.5 : -0.5));
        return [a * width + tilt * b * height, b * height, this.trajectory.dimension === 3 ? c * depth : 0];
    }

    show(frame) {
        const tilt = this.trajectory.tilts[frame];
        this.edges.forEach((corner, index) => this.place.setXYZ(index, ...this.#corner(corner, tilt)));
        this.place.needsUpdate = true;
        const front = this.trajectory.dimension === 3 ? 4 : 0;
        const ends = [[front, front | 1], [front, front | 2], [1, 5]]; // the edges that the words stand beside
        const away = 0.06 * Math.max(...this.trajectory.size);
        this.words.forEach((word, axis) => {
            const [from, to] = ends[axis].map((corner) => this.#corner(corner, tilt));
            const middle = from.map((value, index) => 0.5 * (value + to[index]));
            word.position.set(middle[0] + [0, -away, away][axis], middle[1] + [-away, 0, -away][axis], middle[2]);
        });
    }

    setDark(dark) {
        this.lines.material.color.set(dark ? "#9aa3ad" : "#5a6068");
        const height = (this.trajectory.dimension === 3 ? 0.075 : 0.055) * Math.max(...this.trajectory.size);
        this.words.forEach((word, axis) => {
            word.material.map?.dispose();
            const canvas = written(WORDS[axis], dark ? "#c8cdd3" : "#40454b", axis === 1);
            word.material.map = new CanvasTexture(canvas);
            word.material.needsUpdate = true;
            word.scale.set((height * canvas.width) / 48, (height * canvas.height) / 48, 1);
        });
    }
}

// A word on a canvas of its own; turned to run upwards where it stands beside the box.
function written(word, color, upright) {
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d");
    const font = "30px sans-serif";
    pen.font = font;
    const width = Math.ceil(pen.measureText(word).width) + 8;
    [canvas.width, canvas.height] = upright ? [48, width] : [width, 48];
    pen.translate(canvas.width / 2, canvas.height / 2);
    if (upright) pen.rotate(-Math.PI / 2);
    pen.font = font;
    pen.fillStyle = color;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(word, 0, 0);
    return canvas;
}
