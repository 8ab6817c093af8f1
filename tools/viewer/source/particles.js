// Constituents of bodies as spheres, solvent as smaller translucent dots.

import {
    BufferAttribute, BufferGeometry, CanvasTexture, Color, IcosahedronGeometry, InstancedMesh, Matrix4,
    MeshLambertMaterial, Points, PointsMaterial, Vector3,
} from "three";

const MANY = 4000; // spheres from which on they have fewer faces

export class Particles {
    constructor(trajectory) {
        this.trajectory = trajectory;
        const [solvent, spheres] = [trajectory.solvent, trajectory.count - trajectory.solvent];
        const geometry = new IcosahedronGeometry(1, spheres > MANY ? 1 : 3);
        this.bodies = new InstancedMesh(geometry, new MeshLambertMaterial(), spheres);
        this.bodies.frustumCulled = false;
        this.place = new BufferAttribute(new Float32Array(3 * solvent), 3);
        this.color = new BufferAttribute(new Float32Array(3 * solvent), 3);
        const dots = new BufferGeometry().setAttribute("position", this.place).setAttribute("color", this.color);
        this.solvent = new Points(dots, new PointsMaterial({
            size: 2 * trajectory.radii[0], map: disc(), vertexColors: true, transparent: true, opacity: 0.55,
            depthWrite: false,
        }));
        this.solvent.frustumCulled = false;
    }

    // A dot's size is a length under a perspective camera, but pixels under the other one.
    scaleDots(pixelsPerLength) {
        this.solvent.material.size = 2 * this.trajectory.radii[0] * pixelsPerLength;
    }

    show(frame) {
        const [at, matrix, { trajectory }] = [new Vector3(), new Matrix4(), this];
        for (let particle = 0; particle < trajectory.count; particle++) {
            trajectory.position(frame, particle, at);
            if (particle < trajectory.solvent) {
                this.place.setXYZ(particle, at.x, at.y, at.z);
            } else {
                const radius = trajectory.radii[trajectory.kind[particle]];
                matrix.makeScale(radius, radius, radius).setPosition(at);
                this.bodies.setMatrixAt(particle - trajectory.solvent, matrix);
            }
        }
        this.place.needsUpdate = true;
        this.bodies.instanceMatrix.needsUpdate = true;
    }

    paint(coloring, frame) {
        const [color, { trajectory }] = [new Color(), this];
        for (let particle = 0; particle < trajectory.count; particle++) {
            coloring.of(frame, particle, color);
            if (particle < trajectory.solvent) this.color.setXYZ(particle, color.r, color.g, color.b);
            else this.bodies.setColorAt(particle - trajectory.solvent, color);
        }
        this.color.needsUpdate = true;
        if (this.bodies.instanceColor) this.bodies.instanceColor.needsUpdate = true;
    }
}

// A round dot, for points are square.
function disc() {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 64;
    const pen = canvas.getContext("2d");
    pen.fillStyle = "#ffffff";
    pen.arc(32, 32, 31, 0, 2 * Math.PI);
    pen.fill();
    return new CanvasTexture(canvas);
}
