// Strokes of mouse and finger. The first one of a gesture cuts or grabs; the second finger and the
// right button turn the camera.

/** Pixels below which a stroke is a tap. */
const TAP = 8;
/** Length that a line gains at both ends, relative to the screen. */
const REACH = 2;

export class Pointer {
  constructor(view, line, actions) {
    Object.assign(this, { view, line, actions, stroke: null, fingers: new Set() });
    const canvas = view.canvas;
    // Before the listeners of the camera, which then sees whether it may turn.
    canvas.addEventListener("pointerdown", (e) => this.down(e), { capture: true });
    canvas.addEventListener("pointermove", (e) => this.move(e));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (e) => this.up(e), { capture: true });
    }
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  }

  down(event) {
    this.fingers.add(event.pointerId);
    const turns = event.button !== 0 || this.actions.tool() === "turn" || this.fingers.size > 1;
    this.view.controls.enabled = turns;
    if (turns) {
      this.end(false);
      return;
    }
    this.view.canvas.setPointerCapture(event.pointerId);
    const tool = this.actions.tool();
    const [x, y] = [event.clientX, event.clientY];
    this.stroke = { tool, id: event.pointerId, from: [x, y], to: [x, y], point: null };
    if (tool === "cut") this.actions.beginCut(this.view.edge(x, y));
    if (tool === "grab") {
      const { origin, direction } = this.view.ray(x, y);
      const vectors = [origin, direction].map((v) => new Float64Array(v.toArray()));
      this.stroke.point = this.actions.grab(...vectors);
    }
  }

  move(event) {
    const { stroke, view } = this;
    if (!stroke || event.pointerId !== stroke.id) return;
    const [x, y] = (stroke.to = [event.clientX, event.clientY]);
    if (stroke.tool === "slice") this.draw(stroke);
    if (stroke.tool === "cut") this.actions.moveCut(view.edge(x, y));
    if (stroke.tool === "grab" && stroke.point) {
      this.actions.drag(view.pointAtDepth(x, y, stroke.point));
    }
  }

  up(event) {
    this.fingers.delete(event.pointerId);
    if (this.stroke?.id === event.pointerId) this.end(event.type === "pointerup");
  }

  /** Ends a stroke; a line cuts when it is complete. */
  end(isComplete) {
    const { stroke, view } = this;
    this.stroke = null;
    this.line.style.visibility = "hidden";
    if (!stroke) return;
    if (stroke.tool === "cut") this.actions.endCut();
    if (stroke.tool === "grab") this.actions.release();
    const [dx, dy] = [stroke.to[0] - stroke.from[0], stroke.to[1] - stroke.from[1]];
    const length = Math.hypot(dx, dy);
    if (stroke.tool !== "slice" || !isComplete || length < TAP) return;
    // The cut goes right through: the line is longer than the screen.
    const scale = (REACH * Math.max(innerWidth, innerHeight)) / length;
    const from = view.edge(stroke.from[0] - scale * dx, stroke.from[1] - scale * dy);
    const to = view.edge(stroke.to[0] + scale * dx, stroke.to[1] + scale * dy);
    this.actions.slice(from, to);
  }

  draw({ from, to }) {
    const names = ["x1", "y1", "x2", "y2"];
    [...from, ...to].forEach((c, i) => this.line.setAttribute(names[i], c));
    this.line.style.visibility = "visible";
  }
}
