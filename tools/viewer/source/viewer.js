// The 3D view of a suspension: turns, zooms, colors by species, body or velocity, and plays the trajectory.
//
// Axes as everywhere in tether: x to the right is the flow, y upwards the gradient, z towards the viewer the vorticity.
// A suspension in two dimensions is seen from above and does not turn.

import {
    AmbientLight, Color, DirectionalLight, MOUSE, OrthographicCamera, PerspectiveCamera, Scene, TOUCH, Vector3,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { Box } from "./box.js";
import { Coloring } from "./colors.js";
import { Controls } from "./controls.js";
import { Particles } from "./particles.js";
import { Trajectory } from "./trajectory.js";

const FRAMES_PER_SECOND = 8;

class Viewer {
    constructor(element, description) {
        this.trajectory = new Trajectory(description);
        this.coloring = new Coloring(this.trajectory);
        this.canvas = element.querySelector("canvas");
        this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true });
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.scene = new Scene();
        this.box = new Box(this.trajectory);
        this.particles = new Particles(this.trajectory);
        this.scene.add(this.box.object, this.particles.bodies, this.particles.solvent, new AmbientLight("#ffffff", 1.6));
        this.frame = 0;
        this.playing = false;
        this.#look();
        this.controls = new Controls(element, this);
        this.setDark(document.documentElement.dataset.theme === "dark");
        new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement);
        this.resize();
        this.show(0);
    }

    // Cameras that see all of the box, and what a mouse or fingers do to them.
    #look() {
        const [width, height, depth] = this.trajectory.size;
        this.radius = 0.5 * Math.hypot(width, height, depth);
        const flat = this.trajectory.dimension === 2;
        this.camera = flat ? new OrthographicCamera() : new PerspectiveCamera(32);
        this.camera.up.set(0, 1, 0);
        this.home = flat ? new Vector3(0, 0, 4 * this.radius) : new Vector3(0.42, 0.3, 0.86).multiplyScalar(3.7 * this.radius);
        const sun = new DirectionalLight("#ffffff", 1.9);
        sun.position.set(0.4, 0.8, 1);
        this.camera.add(sun);
        this.scene.add(this.camera);
        this.orbit = new OrbitControls(this.camera, this.canvas);
        this.orbit.enableZoom = false; // until the view is clicked: else the wheel would not scroll the page past it
        this.orbit.enableRotate = !flat;
        if (flat) {
            this.orbit.mouseButtons.LEFT = MOUSE.PAN;
            this.orbit.touches.ONE = TOUCH.PAN;
        }
        this.orbit.addEventListener("change", () => this.draw());
        this.canvas.addEventListener("pointerdown", () => this.canvas.focus({ preventScroll: true }));
        this.canvas.addEventListener("focus", () => { this.orbit.enableZoom = true; });
        this.canvas.addEventListener("blur", () => { this.orbit.enableZoom = false; });
        this.reset();
    }

    // Back to where the view began.
    reset() {
        this.orbit.target.set(0, 0, 0);
        this.camera.position.copy(this.home);
        this.camera.zoom = 1;
        this.camera.updateProjectionMatrix();
        this.orbit.update();
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
        if (!width || !height) return;
        this.renderer.setSize(width, height, false);
        const aspect = width / height;
        if (this.camera.isPerspectiveCamera) {
            this.camera.aspect = aspect;
            this.camera.fov = aspect < 1 ? 2 * Math.atan(Math.tan(0.28) / aspect) * 180 / Math.PI : 32;
        } else {
            const half = this.#halfHeight(aspect);
            Object.assign(this.camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
        }
        this.camera.updateProjectionMatrix();
        this.draw();
    }

    // Of what an orthographic camera sees: all of the box, however it is tilted.
    #halfHeight(aspect) {
        const [width, height] = this.trajectory.size;
        const words = 0.12 * Math.max(width, height);
        return Math.max(0.5 * height + words, (0.5 * width + 0.25 * height + words) / aspect);
    }

    show(frame) {
        const frames = this.trajectory.frames;
        this.frame = (frame + frames) % frames;
        this.box.show(this.frame);
        this.particles.show(this.frame);
        this.particles.paint(this.coloring, this.frame);
        this.controls.update();
        this.draw();
    }

    colorBy(name) {
        this.coloring.by = name;
        this.show(this.frame);
    }

    setDark(dark) {
        this.scene.background = new Color(dark ? "#16191d" : "#fbfbfa");
        this.coloring.dark = dark;
        this.box.setDark(dark);
        this.show(this.frame);
    }

    play(on = !this.playing) {
        this.playing = on;
        this.controls.update();
        clearInterval(this.timer);
        if (on) this.timer = setInterval(() => this.show(this.frame + 1), 1000 / FRAMES_PER_SECOND);
    }

    draw() {
        if (this.camera.isOrthographicCamera) {
            const { clientHeight } = this.canvas.parentElement;
            this.particles.scaleDots((clientHeight * this.camera.zoom) / (this.camera.top - this.camera.bottom));
        }
        this.renderer.render(this.scene, this.camera);
    }
}

// Shows a suspension in an element that holds a canvas and the controls that page.html describes. Without WebGL there
// is a sentence in its place.
export function show(element, description) {
    try {
        element.viewer = new Viewer(element, description);
    } catch (error) {
        element.classList.add("failed");
        element.querySelector(".view").textContent =
            `The 3D view cannot be shown (${error.message}); open the page in a browser with WebGL.`;
        return;
    }
    document.addEventListener("themechange", (event) => element.viewer.setDark(event.detail === "dark"));
}
