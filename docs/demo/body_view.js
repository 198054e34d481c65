// Draws a body with three.js, from views into the memory of the module.

import * as THREE from "three";
import { OrbitControls } from "three/controls";

const SKIN = 0xd9a184;
const CAP = 0xa32c26;

export class BodyView {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
    this.world = new THREE.Scene();
    this.world.background = new THREE.Color(0x20242b);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x555a66, 1.6));
    const sun = new THREE.DirectionalLight(0xffffff, 2.2);
    this.camera.add(sun);
    sun.position.set(1, 2, 1);
    this.world.add(this.camera);
    this.floor = new THREE.GridHelper(1, 20, 0x4a515d, 0x343a44);
    this.world.add(this.floor);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    // Skin and caps share the vertices and differ in indices and material.
    this.parts = [SKIN, CAP].map((color) => {
      const material = new THREE.MeshStandardMaterial({ color, roughness: 0.6, side: 2 });
      const part = new THREE.Mesh(new THREE.BufferGeometry(), material);
      part.frustumCulled = false;
      this.world.add(part);
      return part;
    });
    this.revision = undefined;
    addEventListener("resize", () => this.resize());
  }

  /** Looks at a new body. */
  show(scene, body, { center, diagonal, floor }) {
    this.revision = undefined;
    this.diagonal = diagonal;
    this.floor.position.set(center[0], floor, center[2]);
    this.floor.scale.setScalar(4 * diagonal);
    this.controls.target.fromArray(center);
    const direction = new THREE.Vector3(0.45, 0.35, 1).normalize();
    this.camera.near = 0.01 * diagonal;
    this.camera.far = 50 * diagonal;
    this.camera.position.copy(this.controls.target).addScaledVector(direction, 1.7 * diagonal);
    this.resize();
  }

  resize() {
    const [width, height] = [innerWidth, innerHeight];
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A tall screen keeps the width of the body in view, above the panel.
    this.camera.fov = width < height ? 58 : 40;
    const panel = width < 900 ? 0.12 * height : 0;
    this.camera.setViewOffset(width, height, 0, panel, width, height);
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** Draws the body at its present place. */
  draw(scene, body) {
    const revision = scene.revision(body);
    if (revision !== this.revision) {
      this.revision = revision;
      this.rebuild(scene, body);
    } else {
      // A view may have become invalid since the last frame, so each frame asks for a new one.
      this.move("position", scene.positions(body));
      this.move("normal", scene.normals(body));
    }
    this.renderer.render(this.world, this.camera);
  }

  move(name, values) {
    const attribute = this.parts[0].geometry.getAttribute(name);
    attribute.array.set(values);
    attribute.needsUpdate = true;
  }

  rebuild(scene, body) {
    const position = new THREE.BufferAttribute(scene.positions(body).slice(), 3);
    const normal = new THREE.BufferAttribute(scene.normals(body).slice(), 3);
    const indices = [scene.skinIndices(body).slice(), scene.capIndices(body).slice()];
    this.parts.forEach((part, i) => {
      part.geometry.dispose();
      part.geometry = new THREE.BufferGeometry();
      part.geometry.setAttribute("position", position);
      part.geometry.setAttribute("normal", normal);
      part.geometry.setIndex(new THREE.BufferAttribute(indices[i], 1));
    });
  }

  /** Returns the ray through a point of the screen in pixels. */
  ray(x, y) {
    const point = new THREE.Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight);
    const caster = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(point, this.camera);
    return caster.ray;
  }

  /** Returns the edge of a blade that looks like a point of the screen, from the eye to a plane
   * behind the body. */
  edge(x, y) {
    const { origin } = this.ray(x, y);
    const forward = this.camera.getWorldDirection(new THREE.Vector3());
    const depth = origin.distanceTo(this.controls.target) + 3 * this.diagonal;
    const behind = origin.clone().addScaledVector(forward, depth).toArray();
    return new Float32Array([...origin, ...this.pointAtDepth(x, y, behind)]);
  }

  /** Returns the point on a ray that is as deep in the screen as another point. */
  pointAtDepth(x, y, point) {
    const { origin, direction } = this.ray(x, y);
    const forward = this.camera.getWorldDirection(new THREE.Vector3());
    const depth = new THREE.Vector3(...point).sub(origin).dot(forward);
    return origin.addScaledVector(direction, depth / direction.dot(forward)).toArray();
  }
}
