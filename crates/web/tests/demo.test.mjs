// Cuts the body of the demo with a synthetic pointer. Run `crates/web/build` first.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import test, { after, before } from "node:test";
import module from "./load.mjs";
import { startBrowser } from "./serve.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.stop());

const VIEWPORTS = {
  desktop: { viewport: { width: 1280, height: 800 } },
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
};

/** Returns the middle of the body on the screen: the panel covers the bottom of a phone. */
function middle({ viewport: { width, height } }) {
  return width < 900 ? [width / 2, 0.38 * height] : [width / 2, height / 2];
}

/** Drags a finger where the page has touch, else the mouse. */
async function drag(page, from, to) {
  const hasTouch = await page.evaluate(() => navigator.maxTouchPoints > 0);
  const devtools = hasTouch && (await page.context().newCDPSession(page));
  const touch = (type, ...points) =>
    devtools.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: points.map(([x, y]) => ({ x, y })),
    });
  const move = (point) => (hasTouch ? touch("touchMove", point) : page.mouse.move(...point));
  if (!hasTouch) await page.mouse.move(...from);
  await (hasTouch ? touch("touchStart", from) : page.mouse.down());
  for (let i = 1; i <= 8; i++) {
    const share = i / 8;
    await move([0, 1].map((k) => from[k] + share * (to[k] - from[k])));
    await page.waitForTimeout(30);
  }
  await (hasTouch ? touch("touchEnd") : page.mouse.up());
}

const piecesOf = async (page) => parseInt(await page.textContent("#pieces"), 10);
const waitForPieces = (page, least) =>
  page.waitForFunction(
    (n) => parseInt(document.querySelector("#pieces").textContent, 10) >= n,
    least,
  );

for (const [name, options] of Object.entries(VIEWPORTS)) {
  test(`a line across the body makes two pieces, and undo one (${name})`, async () => {
    const { page, errors } = await browser.open(options);
    await waitForPieces(page, 1);
    assert.equal(await piecesOf(page), 1);
    const [x, y] = middle(options);
    await drag(page, [x - 150, y + 10], [x + 150, y - 10]);
    await waitForPieces(page, 2);
    assert.match(await page.textContent("#cut"), /^cut \d+\.\d ms$/);
    assert.match(await page.textContent("#frame"), /^frame \d+\.\d ms$/);
    await page.click("#undo");
    await page.waitForFunction(() => document.querySelector("#pieces").textContent === "1 piece");
    assert.deepEqual(errors, []);
    await page.context().close();
  });

  test(`all controls are on the screen and large enough for a finger (${name})`, async () => {
    const { page } = await browser.open(options);
    const { width, height } = options.viewport;
    const boxes = await page.$$eval("#tool label, #panel button, select, .button", (all) =>
      all.map((e) => e.getBoundingClientRect().toJSON()),
    );
    assert.equal(boxes.length, 4 + 3 + 4);
    for (const box of boxes) {
      assert.ok(box.left >= 0 && box.right <= width && box.bottom <= height, JSON.stringify(box));
      assert.ok(box.height >= 34 && box.width >= 40, JSON.stringify(box));
    }
    await page.context().close();
  });
}

test("a blade that stops inside leaves one piece with a cut", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  await page.click("label:has(input[value=cut])");
  const [x, y] = middle(VIEWPORTS.desktop);
  await drag(page, [x - 400, y + 60], [x, y + 40]);
  await page.waitForFunction(() => /^cut/.test(document.querySelector("#cut").textContent));
  assert.equal(await piecesOf(page), 1);
  assert.equal(await page.isEnabled("#undo"), true);
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("the error of a refused cut stays after the drag", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  // No cut of this body is refused, so the scene reports one in the frame of a cut.
  await page.evaluate(async () => {
    const { Scene } = await import("incise-web");
    const get = function () {
      return this.cuts > 0 ? ["refused"] : [];
    };
    Object.defineProperty(Scene.prototype, "failedCuts", { get });
  });
  const [x, y] = middle(VIEWPORTS.desktop);
  await drag(page, [x - 150, y + 10], [x + 150, y - 10]);
  await waitForPieces(page, 2);
  await page.waitForTimeout(500);
  assert.equal(await page.textContent("#message"), "refused");
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("a file is opened, cut, and its pieces are downloaded", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  const model = module.Mesh.model("Sphere768");
  const buffer = Buffer.from(model.toObj());
  await page.setInputFiles("#file", { name: "ball.obj", mimeType: "text/plain", buffer });
  await page.waitForFunction(() => document.querySelector("#message").textContent.includes("768"));
  const [x, y] = middle(VIEWPORTS.desktop);
  await drag(page, [x - 150, y], [x + 150, y - 20]);
  await waitForPieces(page, 2);
  for (const format of ["obj", "glb"]) {
    const [saved] = await Promise.all([page.waitForEvent("download"), page.click(`#${format}`)]);
    assert.equal(saved.suggestedFilename(), `pieces.${format}`);
    const bytes = new Uint8Array(await readFile(await saved.path()));
    const mesh = module.Mesh.read(bytes, format);
    assert.equal(mesh.check().components, 2);
    assert.ok(mesh.triangleCount > 768, "caps are added");
  }
  assert.deepEqual(errors, []);
  await page.context().close();
});

/** Returns an OBJ file of a ball with a given scale. */
function ball(scale) {
  const text = new TextDecoder().decode(module.Mesh.model("Sphere80").toObj());
  const scaled = (line) => {
    const [head, ...numbers] = line.split(" ");
    return head === "v" ? `v ${numbers.map((x) => x * scale).join(" ")}` : line;
  };
  const buffer = Buffer.from(text.split("\n").map(scaled).join("\n"));
  return { name: "ball.obj", mimeType: "text/plain", buffer };
}

test("a body too small or too large is a message, and the body stays", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  for (const scale of [1e-20, 1e20]) {
    await page.setInputFiles("#file", ball(scale));
    await page.waitForFunction((size) => {
      const { textContent } = document.querySelector("#message");
      return textContent.includes(size) && textContent.includes("open one of");
    }, scale < 1 ? "e-20 m" : "e+20 m");
  }
  const [x, y] = middle(VIEWPORTS.desktop);
  await drag(page, [x - 150, y], [x + 150, y - 20]);
  await waitForPieces(page, 2);
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("bodies of a tenth of a millimeter and of a kilometer are cut", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  for (const scale of [1e-4, 1e3]) {
    await page.setInputFiles("#file", ball(scale));
    await page.waitForFunction(() => document.querySelector("#message").textContent.includes("80"));
    await page.waitForFunction(() => document.querySelector("#pieces").textContent === "1 piece");
    const [x, y] = middle(VIEWPORTS.desktop);
    await drag(page, [x - 150, y], [x + 150, y - 20]);
    await waitForPieces(page, 2);
  }
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("a broken file is a message, and the body stays", async () => {
  const { page, errors } = await browser.open(VIEWPORTS.desktop);
  const buffer = Buffer.from("v 0 0 x\n");
  await page.setInputFiles("#file", { name: "bad.obj", mimeType: "text/plain", buffer });
  const hasMessage = () => document.querySelector("#message").textContent.includes("line 1");
  await page.waitForFunction(hasMessage);
  assert.equal(await piecesOf(page), 1);
  assert.deepEqual(errors, []);
  await page.context().close();
});
