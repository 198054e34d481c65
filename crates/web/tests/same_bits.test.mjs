// The module gives the same bits as Rust: the lines of `tests/seeded_cuts.txt`, which a Rust test
// verifies. Run `crates/web/build` first.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import module from "./load.mjs";

const { Mesh, Scene } = module;
const LIST = new URL("../../../tests/seeded_cuts.txt", import.meta.url);

/** Returns the CRC-32 of a typed array that follows those of `crc`. */
function crc32(crc, { buffer, byteOffset, byteLength }) {
  crc = ~crc;
  for (const byte of new Uint8Array(buffer, byteOffset, byteLength)) {
    crc ^= byte;
    for (let i = 0; i < 8; i++) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
  }
  return ~crc;
}

function hash(meshes) {
  let crc = 0;
  for (const mesh of meshes) {
    crc = crc32(crc, mesh.positions());
    crc = crc32(crc, mesh.triangles());
    mesh.free();
  }
  return (crc >>> 0).toString(16).padStart(8, "0");
}

function cut(mesh, level, [x, y, z, d]) {
  mesh.cut(new Float64Array([x, y, z]), d, { level });
  const pieces = Array.from(mesh.pieceNumbers(), (number) => mesh.piece(number));
  return `${pieces.length} ${hash(pieces)}`;
}

/** Lets a body fall on the ground, and cuts it in frames 10 and 11. */
function fall(mesh, [x, y, z, d]) {
  const scene = new Scene();
  scene.setColliders([{ plane: { point: [0, d, 0], normal: [0, 1, 0] } }]);
  const body = scene.addBody(mesh);
  const edge = (x) => new Float32Array([x, y, -z, x, y, z]);
  const blade = scene.addBlade(edge(-x));
  for (let frame = 0; frame < 90; frame++) {
    if (frame === 10) scene.moveBlade(blade, edge(0));
    else if (frame === 11) scene.moveBlade(blade, edge(x));
    scene.step();
  }
  return `${scene.pieceCount(body)} ${hash([scene.mesh(body)])}`;
}

test("seeded cuts and a scene have the bits of Rust", () => {
  const lines = readFileSync(LIST, "utf8").trim().split("\n").map((line) => line.split(" "));
  assert.equal(lines.length, 91);
  for (const [name, method, level, ...rest] of lines) {
    // A mesh has no cut by the path of a blade here.
    if (method === "path") continue;
    const numbers = rest.slice(0, 4).map(Number);
    const expected = rest.slice(4).join(" ");
    const model = Mesh.model(name);
    const mesh = new Mesh(model.positions().slice(), model.triangles().slice());
    const isScene = method === "scene";
    const run = () => (isScene ? fall(mesh, numbers) : cut(mesh, level, numbers));
    if (expected === "refused") assert.throws(run);
    else assert.equal(run(), expected, `${name} ${method} ${numbers}`);
  }
});
