// Cuts a soft body with mouse or finger: the module simulates, three.js draws.

import init, { Mesh, Scene } from "incise-web";
import { BodyView } from "./body_view.js";
import { Pointer } from "./pointer.js";

const element = (id) => document.getElementById(id);
/** Height of the body above the floor and longest step of a drag, in diagonals of the body. */
const DROP = 0.05;
const MAX_DRAG = 0.04;
/** Gravity in diagonals of the body per square second, so that bodies of all sizes move alike. */
const GRAVITY = -9.81;
/** Smallest and largest diagonal of a body in meters. */
const SIZES = [1e-6, 1e6];

/** The body, its scene and the state of a stroke. */
const state = {
  mesh: null,
  scene: null,
  body: 0,
  blade: 0,
  diagonal: 1,
  center: [0, 0, 0],
  /** Number of cuts of each stroke, for undo. */
  strokes: [],
  /** Whether the present stroke has an error, which stays on the screen. */
  hasFailed: false,
  /** Where a grabbed vertex is and where it goes. */
  drag: null,
};
let view;

function say(text) {
  element("message").textContent = text;
}

/** Runs a command and shows its error, which is the text of the library. */
function attempt(command) {
  try {
    return command();
  } catch (error) {
    state.hasFailed = true;
    say(error.message ?? String(error));
    return undefined;
  }
}

/** Starts anew with a mesh at rest above a floor. */
function start(mesh) {
  const [x0, y0, z0, x1, y1, z1] = mesh.bounds();
  const diagonal = Math.hypot(x1 - x0, y1 - y0, z1 - z0);
  if (!(diagonal >= SIZES[0] && diagonal <= SIZES[1])) {
    const size = diagonal.toExponential(1);
    say(`The body is ${size} m large; open one of ${SIZES.join(" to ")} m.`);
    mesh.free();
    return;
  }
  const scene = new Scene();
  const body = attempt(() => scene.addBody(mesh));
  if (body === undefined) {
    scene.free();
    return;
  }
  if (mesh !== state.mesh) state.mesh?.free();
  state.scene?.free();
  const center = [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2];
  const ground = y0 - DROP * diagonal;
  scene.set({ gravity: [0, GRAVITY * diagonal, 0] });
  scene.setColliders([{ plane: { point: [0, ground, 0], normal: [0, 1, 0] } }]);
  Object.assign(state, { mesh, scene, body, diagonal, center, strokes: [], drag: null });
  state.blade = scene.addBlade(new Float32Array(6));
  applySettings();
  view.show(scene, body, { center, diagonal, floor: ground });
  element("cut").textContent = "";
}

function applySettings() {
  state.scene.set({ level: element("level").value });
}

/** Cuts right through along a line on the screen, given the blade at both of its ends. */
function slice(from, to) {
  const { scene, blade } = state;
  state.strokes.push(0);
  state.hasFailed = false;
  scene.setFullSlices(blade, true);
  scene.teleportBlade(blade, from);
  scene.moveBlade(blade, to);
  step();
  finishStroke("The line misses the body.");
}

function beginCut(edge) {
  const { scene, blade } = state;
  state.strokes.push(0);
  state.hasFailed = false;
  scene.setFullSlices(blade, false);
  scene.teleportBlade(blade, edge);
  // The walls of a cut that ends inside touch each other.
  scene.set({ contacts: { self_collision: true } });
}

function finishStroke(nothing) {
  if (state.strokes.at(-1) === 0) {
    state.strokes.pop();
    if (nothing && !state.hasFailed) say(nothing);
  }
}

function undo() {
  const cuts = state.strokes.pop() ?? 0;
  for (let i = 0; i < cuts; i++) {
    if (attempt(() => (state.scene.undo(), true)) === undefined) break;
  }
  state.scene.wake(state.body);
}

/** Moves the grabbed vertex toward the pointer, slowly enough for the triangles around it. */
function moveGrabbed() {
  if (!state.drag) return;
  const { at, target } = state.drag;
  const way = target.map((c, k) => c - at[k]);
  const share = Math.min(1, (MAX_DRAG * state.diagonal) / Math.max(Math.hypot(...way), 1e-9));
  state.drag.at = at.map((c, k) => c + share * way[k]);
  state.scene.drag(...state.drag.at);
}

/** Steps the scene by one frame and shows its figures. */
function step() {
  const { scene } = state;
  moveGrabbed();
  scene.step();
  element("frame").textContent = `frame ${scene.frameMilliseconds.toFixed(1)} ms`;
  if (scene.cuts > 0) {
    if (state.strokes.length > 0) state.strokes[state.strokes.length - 1] += scene.cuts;
    element("cut").textContent = `cut ${scene.cutMilliseconds.toFixed(1)} ms`;
    say("");
  }
  for (const text of scene.failedCuts) {
    state.hasFailed = true;
    say(text);
  }
  const pieces = scene.pieceCount(state.body);
  element("pieces").textContent = pieces === 1 ? "1 piece" : `${pieces} pieces`;
  element("undo").disabled = state.strokes.length === 0;
}

function download(format) {
  attempt(() => {
    const mesh = state.scene.mesh(state.body);
    const bytes = format === "obj" ? mesh.toObj() : mesh.toGlb();
    mesh.free();
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
    link.download = `pieces.${format}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
}

async function open(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const mesh = attempt(() => Mesh.read(bytes, file.name.split(".").pop()));
  if (!mesh) return;
  say([`${file.name}: ${mesh.triangleCount} triangles`, ...mesh.warnings].join("; "));
  start(mesh);
}

/** What strokes of the pointer do. */
const actions = {
  tool: () => document.querySelector("input[name=tool]:checked").value,
  slice: (from, to) => attempt(() => slice(from, to)),
  beginCut: (edge) => attempt(() => beginCut(edge)),
  moveCut: (edge) => attempt(() => state.scene.moveBlade(state.blade, edge)),
  endCut() {
    // The last motion of the blade.
    attempt(step);
    finishStroke("The blade misses the body.");
  },
  grab(origin, direction) {
    return attempt(() => {
      const hit = state.scene.pick(state.body, origin, direction);
      if (!hit) return undefined;
      const point = Array.from(origin, (c, k) => c + hit.distance * direction[k]);
      state.scene.grab(state.body, hit.vertex);
      state.drag = { at: point, target: point };
      hit.free();
      return point;
    });
  },
  drag(target) {
    if (state.drag) state.drag.target = target;
  },
  release() {
    state.drag = null;
    attempt(() => state.scene.release());
  },
};

function listen() {
  element("model").addEventListener("change", (e) => start(Mesh.model(e.target.value)));
  element("level").addEventListener("change", () => attempt(applySettings));
  element("undo").addEventListener("click", undo);
  element("reset").addEventListener("click", () => start(state.mesh));
  element("file").addEventListener("change", (e) => {
    if (e.target.files[0]) open(e.target.files[0]);
    e.target.value = "";
  });
  for (const format of ["obj", "glb"]) {
    element(format).addEventListener("click", () => download(format));
  }
}

await init();
view = new BodyView(element("view"));
new Pointer(view, element("stroke").querySelector("line"), actions);
listen();
start(Mesh.model("Bunny"));
// Frames of 60 a second, also on screens that draw more; after a pause no frame is caught up.
let due = 0;
view.renderer.setAnimationLoop((now) => {
  if (now >= due - 1) {
    due = Math.max(due + 1000 / 60, now);
    attempt(step);
  }
  view.draw(state.scene, state.body);
});
document.body.dataset.ready = "true";
