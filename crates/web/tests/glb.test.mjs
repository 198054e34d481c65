// Files of glTF by the module and by the program are valid for Khronos' validator, and three.js
// reads them.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import validator from "gltf-validator";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import module from "./load.mjs";

const root = fileURLToPath(new URL("../../../", import.meta.url));
const program = join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "debug", "incise");

/** Returns what three.js reads from the bytes of a file, which must be valid. */
async function read(bytes) {
  const { issues } = await validator.validateBytes(bytes);
  const found = issues.messages.filter((message) => message.severity < 2);
  assert.deepEqual(found, [], "errors and warnings");
  const copy = bytes.slice();
  return new GLTFLoader().parseAsync(copy.buffer, "");
}

/** Returns the number of triangles below a node of three.js. */
function triangles(node) {
  let count = 0;
  node.traverse((part) => {
    count += (part.geometry?.index?.count ?? 0) / 3;
  });
  return count;
}

/** Runs the program with an output file, and returns the file's bytes. */
function made(command) {
  const folder = mkdtempSync(join(tmpdir(), "incise-"));
  const file = join(folder, "out.glb");
  const run = spawnSync(program, command(file), { cwd: root, encoding: "utf8" });
  const bytes = run.status === 0 ? new Uint8Array(readFileSync(file)) : null;
  rmSync(folder, { recursive: true });
  assert.ok(bytes, `${program}: ${run.error ?? run.stderr}`);
  return bytes;
}

test("pieces of a cut mesh are nodes with skin and caps", async () => {
  const mesh = module.Mesh.model("Banana");
  mesh.cut(new Float64Array([1, 0.1, 0.1]), 0.02);
  const { scene } = await read(mesh.toGlb());
  assert.equal(scene.children.length, 2);
  assert.equal(triangles(scene), mesh.triangleCount);
  for (const piece of scene.children) {
    const names = piece.children.map((part) => Object.keys(part.geometry.attributes).sort());
    assert.deepEqual(names, [["normal", "position", "uv"], ["normal", "position", "uv"]]);
  }
});

test("incise cut writes one file for all inputs and pieces", async () => {
  const plane = ["--plane", "1,0.1,0.1,0.02", "-o"];
  const { scene } = await read(made((file) => ["cut", "Banana", "Sphere80", ...plane, file]));
  assert.equal(scene.children.length, 4);
});

test("incise simulate exports motion as morph targets", async () => {
  const input = "crates/app/scenes/bunny_slices.toml";
  const file = await read(made((out) => ["simulate", input, "--export", out]));
  assert.equal(file.animations.length, 1);
  const [animation] = file.animations;
  assert.ok(animation.tracks.length > 0);
  assert.ok(Math.abs(animation.duration - 2) < 0.05, `${animation.duration} s`);
  const morphs = [];
  file.scene.traverse((part) => morphs.push(...(part.geometry?.morphAttributes?.position ?? [])));
  assert.ok(morphs.length > 0);
});
