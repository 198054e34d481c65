// The module gives the same bits as Rust. Run `crates/web/build` first.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import test from "node:test";
import { lines } from "./cuts.mjs";
import module from "./load.mjs";

test("100 seeded cuts and a scene have the bits of Rust", () => {
  const run = ["run", "--quiet", "--package", "incise-web", "--example", "cut_hashes"];
  const expected = execFileSync("cargo", run, { encoding: "utf8" }).trim().split("\n");
  const found = lines(module);
  assert.equal(found.length, 101);
  assert.ok(found.filter((line) => /^\d+ [0-9a-f]{8} /.test(line)).length > 90, "few are refused");
  assert.deepEqual(found, expected);
});
