// The contract of the module for JavaScript: views, exceptions, and no trap for hostile input.

import assert from "node:assert/strict";
import test from "node:test";
import module from "./load.mjs";

const { IncisionState, Mesh, Scene } = module;
const TRIANGLE = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);

/** Checks that a call throws an error with the text of the library, not a trap. */
function refuses(call, text) {
  assert.throws(call, (error) => {
    assert.ok(!(error instanceof WebAssembly.RuntimeError), `trap: ${error.stack}`);
    assert.match(String(error.message), text);
    return true;
  });
}

test("views have the memory of the module and the shapes of the mesh", () => {
  const mesh = Mesh.model("Bunny");
  mesh.cut(new Float64Array([0, 1, 0]), 0.1);
  const [count, triangles] = [mesh.vertexCount, mesh.triangleCount];
  const positions = mesh.positions();
  assert.equal(positions.buffer, mesh.triangles().buffer, "no copy");
  assert.equal(positions.length, 3 * count);
  assert.equal(mesh.triangles().length, 3 * triangles);
  assert.equal(mesh.capMask().length, triangles);
  const pieces = new Set(mesh.trianglePieces());
  assert.deepEqual([...pieces].sort(), [...mesh.pieceNumbers()]);
  assert.ok(mesh.triangles().every((v) => v < count));
});

test("a scene moves the positions that its views show", () => {
  const scene = new Scene();
  const body = scene.addBody(Mesh.model("Sphere80"));
  const before = scene.positions(body).slice();
  scene.step();
  const after = scene.positions(body);
  assert.equal(before.length, after.length);
  assert.ok(before.some((x, i) => i % 3 === 1 && after[i] < x), "it falls");
  assert.ok(scene.normals(body).every(Number.isFinite));
});

test("hostile arrays are exceptions", () => {
  const triangles = new Uint32Array([0, 1, 2]);
  refuses(() => new Mesh(TRIANGLE, new Uint32Array([0, 1, 3])), /index 3 is out of range/);
  refuses(() => new Mesh(TRIANGLE, new Uint32Array([0, 1, 0xffffffff])), /out of range/);
  refuses(() => new Mesh(TRIANGLE, new Uint32Array(4)), /multiple of 3/);
  refuses(() => new Mesh(new Float32Array(9).fill(NaN), triangles), /not a finite/);
  refuses(() => new Mesh([0, 0, 0], triangles), /not a Float32Array/);
  refuses(() => new Mesh({ length: 2 ** 40 }, triangles), /not a Float32Array/);
  refuses(() => new Mesh(TRIANGLE, new Float32Array(3)), /not a Uint32Array/);
  refuses(() => new Mesh(TRIANGLE, undefined), /./);
  refuses(() => new Mesh(new Float32Array(2 ** 30), triangles), /memory has no room/);
  refuses(() => Mesh.read(new Uint8Array(0), "obj"), /./);
  refuses(() => Mesh.read(new Uint8Array([0x67, 0x6c, 0x54, 0x46]), "glb"), /./);
  refuses(() => Mesh.model("Teapot"), /no model/);
  assert.equal(new Mesh(TRIANGLE, triangles).pieceCount, 1, "the module works on");
});

test("hostile cuts and ids are exceptions", () => {
  const mesh = Mesh.model("Sphere80");
  refuses(() => mesh.cut(new Float64Array(3), 0), /no area/);
  refuses(() => mesh.cut(new Float64Array([Infinity, 0, 0]), 0), /not finite/);
  refuses(() => mesh.cut(new Float64Array([0, NaN, 0]), 0), /the normal is not finite.*NaN/);
  refuses(() => mesh.cut(new Float64Array([0, 1, 0])), /d is not finite.*NaN/);
  refuses(() => mesh.cut(new Float64Array([0, 1, 0]), Infinity), /d is not finite/);
  refuses(() => mesh.cut(new Float64Array(2), 0), /pass 3/);
  refuses(() => mesh.cut(new Float64Array([0, 1, 0]), 0, { level: "finest" }), /level is 'finest'/);
  refuses(() => mesh.cut(new Float64Array([0, 1, 0]), 0, 0.5), /must be values by name/);
  refuses(() => Mesh.model(5), /expected a string/);
  refuses(() => mesh.piece(5), /no piece 5/);
  refuses(() => mesh.undo(), /no cut to undo/);
  const scene = new Scene();
  refuses(() => scene.positions(0), /no body 0/);
  refuses(() => scene.addBody(new Scene()), /expected instance of Mesh/);
  const body = scene.addBody(mesh);
  refuses(() => scene.grab(body, 1e9), /./);
  refuses(() => scene.drag(NaN, 0, 0), /the point is not finite.*NaN/);
  for (const bad of [NaN, 0.5, -1, 2 ** 32, undefined]) {
    const number = new RegExp(`no body ${bad ?? NaN};`);
    refuses(() => scene.positions(bad), number);
    refuses(() => scene.removeBody(bad), number);
    refuses(() => scene.pick(bad, new Float64Array(3), new Float64Array(3)), number);
    refuses(() => scene.grab(body, bad), /no vertex/);
    refuses(() => scene.moveBlade(bad, new Float32Array(6)), /no blade/);
    refuses(() => mesh.piece(bad), /no piece/);
  }
  assert.deepEqual([...scene.origin], [0, 0, 0]);
  refuses(() => scene.moveBlade(0, new Float32Array(6)), /no blade 0/);
  // Of 2 GiB: no copy is made of an array of the wrong length.
  refuses(() => scene.addBlade(new Float32Array(2 ** 29)), /536870912 numbers; pass 6/);
  refuses(() => mesh.cut(new Float64Array(2 ** 28), 0), /268435456 numbers; pass 3/);
  refuses(() => scene.addBlade([0, 0, 0, 1, 0, 0]), /not a Float32Array/);
  refuses(() => scene.addBlade(undefined), /./);
  for (const bad of [NaN, Infinity]) {
    refuses(() => scene.set({ dt: bad }), /dt is .*; it must be a finite number above 0/);
    refuses(() => scene.set({ residual: bad }), /residual is .*; it must be a finite number/);
    const ball = { center: [0, bad, 0], radius: 1 };
    refuses(() => scene.setColliders([{ sphere: ball }]), /collider 0/);
    refuses(() => scene.set({ gravity: [0, bad, 0] }), /gravity is/);
    const edge = new Float32Array([0, 0, 0, 0, bad, 0]);
    refuses(() => scene.addBlade(edge), /edge of the blade has the coordinate/);
    const [here, there] = [new Float64Array(3), new Float64Array([0, bad, 0])];
    refuses(() => scene.pick(body, there, here), /origin of the ray/);
    refuses(() => scene.pick(body, here, there), /direction of the ray/);
  }
  const blade = scene.addBlade(new Float32Array([-2, 0, 0, -2, 1, 0]));
  refuses(() => scene.moveBlade(blade, new Float32Array(6).fill(NaN)), /coordinate NaN/);
  refuses(() => scene.teleportBlade(blade, new Float32Array(6).fill(NaN)), /coordinate NaN/);
  for (const bad of [-1, 0, 1.5, NaN, 2 ** 32]) {
    refuses(() => scene.set({ iterations: bad }), /iterations is/);
  }
  for (const bad of [-1, 0, NaN, Infinity]) {
    refuses(() => scene.set({ substep: bad }), /substep is .*; it must be/);
  }
  assert.equal(scene.get("substep"), 0.0013888889);
  assert.equal(scene.params.solver.substep, 0.0013888889);
  refuses(() => scene.set({ floor: 0 }), /no parameter 'floor'; the names are dt/);
  refuses(() => scene.setColliders(5), /a list of objects/);
  refuses(() => scene.setColliders([{ cone: {} }]), /colliders\[0\] is .* plane, sphere/);
  refuses(() => scene.setColliders([{ sphere: { radius: 1 } }]), /colliders\[0\].center is/);
  scene.setColliders([{ plane: { point: [0, -3, 0], normal: [0, 1, 0] } }]);
  scene.set({ gravity: new Float32Array([0, -1, 0]), contacts: { self_collision: true } });
  assert.deepEqual(scene.get("gravity"), [0, -1, 0]);
  assert.equal(scene.get("contacts.self_collision"), true);
  scene.step();
  mesh.free();
  refuses(() => mesh.triangleCount, /moved value/);
});

test("an incision tells where its blade is", () => {
  const scene = new Scene();
  const body = scene.addBody(Mesh.model("Sphere768"));
  scene.set({ gravity: [0, 0, 0] });
  const blade = scene.addBlade(new Float32Array([-2, 0, -2, -2, 0, 2]));
  assert.equal(scene.incision(blade, body).state, IncisionState.Outside);
  const { Outside, Inside, Abandoned, Finished } = IncisionState;
  const edge = (x, y) => new Float32Array([x, y, -2, x, y, 2]);
  const moveTo = (x, y, state) => {
    scene.moveBlade(blade, edge(x, y));
    scene.step();
    const incision = scene.incision(blade, body);
    assert.deepEqual([incision.state, incision.refusedSteps], [state, 0], `${x}, ${y}`);
  };
  moveTo(0, 0, Inside);
  moveTo(2, 0, Finished);
  scene.teleportBlade(blade, edge(-2, 0.2));
  assert.equal(scene.incision(blade, body).state, Outside);
  moveTo(0, 0.2, Inside);
  moveTo(-1.5, 1.2, Abandoned);
  assert.equal(IncisionState[Finished], "Finished");
  refuses(() => scene.incision(5, body), /no blade 5/);
  refuses(() => scene.incision(blade, 5), /no body 5/);
});

test("a loaded scene goes on with the same bits", () => {
  const scene = new Scene();
  const body = scene.addBody(Mesh.model("Bunny"));
  scene.step();
  const loaded = Scene.load(scene.save());
  for (const each of [scene, loaded]) for (let i = 0; i < 5; i++) each.step();
  const expected = scene.positions(body).slice();
  assert.deepEqual(loaded.positions(body).slice(), expected);
  refuses(() => Scene.load(new Uint8Array(99)), /./);
});

test("a file far from zero has an origin", () => {
  const far = (x, y) => `v ${1e6 + x} ${y} 0\n`;
  const text = far(0.125, 0) + far(1.125, 0) + far(0.125, 1.0000001) + "f 1 2 3\n";
  const mesh = Mesh.read(new TextEncoder().encode(text), "obj");
  assert.ok(Math.abs(mesh.origin[0] - 1e6) <= 2, `${mesh.origin}`);
  assert.equal(mesh.positions()[0] + mesh.origin[0], 1e6 + 0.125);
  assert.ok(Mesh.model("Bunny").origin.every((x) => x === 0));
});

test("random bytes are no trap in any format", () => {
  let x = 1;
  const next = () => (x = Math.imul(x, 1664525) + 1013904223) >>> 24;
  const [obj, ply] = ["v 0 0 0\nf 1 ", "ply\nformat ascii 1.0\n"];
  const heads = { obj, ply, stl: "solid\n", glb: "glTF" };
  for (const [format, head] of Object.entries(heads)) {
    for (let i = 0; i < 200; i++) {
      const bytes = Uint8Array.from([...Buffer.from(head), ...Array.from({ length: i }, next)]);
      refuses(() => Mesh.read(bytes, format), /./);
    }
  }
});

test("the largest model is cut and stepped", () => {
  const scene = new Scene();
  const body = scene.addBody(Mesh.model("Armadillo"));
  const blade = scene.addBlade(new Float32Array([-2, 0, -2, -2, 0, 2]));
  scene.moveBlade(blade, new Float32Array([2, 0.01, -2, 2, 0.01, 2]));
  scene.step();
  assert.ok(scene.pieceCount(body) > 1);
  scene.undo();
  assert.equal(scene.pieceCount(body), 1);
});
