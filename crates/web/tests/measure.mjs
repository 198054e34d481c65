// Prints times of frames and cuts in node and in Chromium: node tests/measure.mjs

import module from "./load.mjs";
import { startBrowser } from "./serve.mjs";

/** Measures a body that stands on the ground and is cut in two; runs in both engines. */
async function measure({ Mesh, Scene }) {
  const median = (all) => [...all].sort((a, b) => a - b)[all.length >> 1];
  const result = {};
  for (const name of ["Bunny", "Armadillo"]) {
    const mesh = Mesh.model(name);
    const scene = new Scene();
    scene.set({ sleep: false });
    const floor = { point: [0, mesh.bounds()[1], 0], normal: [0, 1, 0] };
    scene.setColliders([{ plane: floor }]);
    const body = scene.addBody(mesh);
    const before = new Float32Array([-2, 0.02, -2, -2, 0, 2]);
    const after = new Float32Array([2, 0.02, -2, 2, 0, 2]);
    const blade = scene.addBlade(before);
    const step = () => {
      const begin = performance.now();
      scene.step();
      scene.positions(body);
      return performance.now() - begin;
    };
    const frames = name === "Bunny" ? 300 : 40;
    const whole = Array.from({ length: frames }, step);
    const cuts = Array.from({ length: 12 }, () => {
      if (scene.undoCount > 0) scene.undo();
      scene.teleportBlade(blade, before);
      scene.moveBlade(blade, after);
      step();
      return scene.cutMilliseconds;
    });
    const pieces = Array.from({ length: frames }, step);
    const planes = Array.from({ length: 40 }, (_, i) => {
      const { seconds } = mesh.cut(new Float64Array([0.1, 1, 0.05]), 0.1 - i * 0.005);
      mesh.undo();
      return seconds.total * 1e3;
    });
    result[name] = {
      frame: median(whole),
      "frame of pieces": median(pieces),
      "first cut": cuts[0],
      cut: median(cuts),
      "cut without scene": median(planes),
      pieces: scene.pieceCount(body),
    };
  }
  return result;
}

console.log("node", process.version);
console.table(await measure(module));
const { open, stop } = await startBrowser();
const { page } = await open({});
console.log("Chromium", page.context().browser().version());
// The frames of the demo itself, drawn by a software renderer where there is no GPU.
const frames = await page.evaluate(async () => {
  const times = [];
  for (let i = 0; i < 120; i++) times.push(await new Promise(requestAnimationFrame));
  return (times.length - 1) / ((times.at(-1) - times[0]) / 1000);
});
const code = `import("incise-web").then(async (module) => {
  await module.default();
  return (${measure})(module);
})`;
console.table(await page.evaluate(code));
console.log(`demo: ${frames.toFixed(1)} frames a second`);
await stop();
