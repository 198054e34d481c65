// The cuts of examples/cut_hashes.rs, by the module.

const MODELS = ["Sphere80", "Sphere768", "Bunny", "Banana"];
const LEVELS = ["2x-coarser", "1.5x-coarser", "original", "1.5x-finer", "2x-finer"];

function hash(mesh) {
  const bytes = mesh.toObj();
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193);
  mesh.free();
  return `${(hash >>> 0).toString(16).padStart(8, "0")} ${bytes.length}`;
}

function cut({ Mesh }, i, next) {
  const mesh = Mesh.model(MODELS[i % 4]);
  const normal = new Float64Array([next(), next(), next()]);
  try {
    mesh.cut(normal, 0.2 * next(), LEVELS[i % 5], i % 7 === 6 ? "paper" : "exact").free();
  } catch (error) {
    return error.message;
  }
  return hash(mesh);
}

function scene({ Mesh, Scene }) {
  const scene = new Scene();
  scene.floor = -0.6;
  const body = scene.addBody(Mesh.model("Bunny"));
  const blade = scene.addBlade(new Float32Array([-2, 0, -2, -2, 0, 2]));
  for (let frame = 0; frame < 90; frame++) {
    if (frame === 10) scene.moveBlade(blade, new Float32Array([0, 0.1, -2, 0, 0.1, 2]));
    else if (frame === 11) scene.moveBlade(blade, new Float32Array([2, 0, -2, 2, 0, 2]));
    scene.step();
  }
  return hash(scene.mesh(body));
}

/** Returns the lines that the example prints. */
export function lines(module) {
  let x = 20261125;
  const next = () => {
    x ^= x << 13;
    x ^= x >>> 17;
    x ^= x << 5;
    return (x >>> 0) / 2 ** 31 - 1;
  };
  const cuts = Array.from({ length: 100 }, (_, i) => `${i} ${cut(module, i, next)}`);
  return [...cuts, `scene ${scene(module)}`];
}
