/*
The stage: pictures in space side by side, all seen from one direction, on one canvas.

A panel is a place in the page with a scene of its own. One WebGL canvas as large as the window lies
over the page, and each panel in sight is drawn into its rectangle. The canvas scrolls with the page
and is put back over the window in each frame. Nothing is drawn unless something changed. Where there
is no panel the canvas is not shown, and a browser without WebGL shows all that is no picture in space.

Lattice coordinates are those of the scene: axis 2 is up.
*/

import {
  AmbientLight,
  BackSide,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  FrontSide,
  InstancedMesh,
  Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Object3D,
  OctahedronGeometry,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { element } from "./dom.ts";
import { type Point } from "./tables.ts";

/** From here no plane of a tile on even values is seen edge on. */
export const START = { turn: -64, tilt: 15, zoom: 1 };
const FIELD_OF_VIEW = 24;
const MOST_PIXELS = 7e6;
const RADIANS = Math.PI / 180;

export interface View {
  turn: number;
  tilt: number;
  zoom: number;
}

/** The kinds of lines, with their colour's variable in the style sheet, width, and whether dashed. */
const LINES = {
  lattice: ["--lattice", 1.2, false],
  mesh: ["--mesh", 1, false],
  polygon: ["--polygon", 2.6, false],
  hyperbola: ["--hyperbola", 3, false],
  asymptote: ["--asymptote", 1.4, true],
  waist: ["--waist", 3.4, false],
  axis: ["--asymptote", 1.2, true],
  open: ["--bad", 4.5, false],
} as const;
export type LineKind = keyof typeof LINES;

const MARKS = {
  inside: ["--inside", "ball", 0.045],
  outside: ["--outside-ball", "ball", 0.045],
  high: ["--inside", "ball", 0.035],
  low: ["--saddle-low", "ball", 0.035],
  body: ["--waist", "octahedron", 0.05],
} as const;
export type MarkKind = keyof typeof MARKS;

const BALL = new SphereGeometry(1, 20, 14);
const OCTAHEDRON = new OctahedronGeometry(1);
const BOX = new BoxGeometry(1, 1, 1);

/** A colour of the style sheet. */
function colour(variable: string): Color {
  return new Color(getComputedStyle(document.documentElement).getPropertyValue(variable).trim());
}

/** The materials of all panels, in the page's colours. */
class Palette {
  readonly lines = new Map<LineKind, LineMaterial>();
  readonly marks = new Map<MarkKind, Material>();
  readonly front = new MeshLambertMaterial({ side: FrontSide });
  readonly back = new MeshLambertMaterial({ side: BackSide });
  readonly clearFront = new MeshLambertMaterial({ side: FrontSide, transparent: true, opacity: 0.82 });
  readonly clearBack = new MeshLambertMaterial({ side: BackSide, transparent: true, opacity: 0.82 });
  readonly box = new MeshBasicMaterial({ transparent: true, opacity: 0.28, side: DoubleSide, depthWrite: false });

  constructor() {
    for (const [kind, [, width, dashed]] of Object.entries(LINES)) {
      const material = new LineMaterial({ linewidth: width, dashed, dashSize: 0.05, gapSize: 0.04 });
      this.lines.set(kind as LineKind, material);
    }
    for (const kind of Object.keys(MARKS)) this.marks.set(kind as MarkKind, new MeshLambertMaterial());
    // Let lines on a surface stand before it.
    for (const one of [this.front, this.back, this.clearFront, this.clearBack]) {
      one.polygonOffset = true;
      one.polygonOffsetFactor = one.polygonOffsetUnits = 1;
    }
    this.paint();
  }

  /** Take the colours of the page's theme. */
  paint(): void {
    for (const [kind, [variable]] of Object.entries(LINES))
      this.lines.get(kind as LineKind)!.color = colour(variable);
    for (const [kind, [variable]] of Object.entries(MARKS))
      (this.marks.get(kind as MarkKind) as MeshLambertMaterial).color = colour(variable);
    for (const one of [this.front, this.clearFront]) one.color = colour("--front");
    for (const one of [this.back, this.clearBack]) one.color = colour("--back");
    this.box.color = colour("--bad");
  }
}

export interface Triangles {
  positions: Float32Array;
  index?: Uint32Array;
  normals?: Float32Array;
  vertices: number;
  indices: number;
}

/** Triangles without shared vertices, for flat shading. */
export function flat(points: readonly Point[], triangles: readonly (readonly number[])[]): Triangles {
  const positions = new Float32Array(9 * triangles.length);
  triangles.forEach((row, n) => row.forEach((node, i) => positions.set(points[node], 9 * n + 3 * i)));
  return { positions, vertices: 3 * triangles.length, indices: 0 };
}

export class Panel {
  readonly scene = new Scene();
  readonly figure: HTMLElement;
  readonly place: HTMLElement;
  readonly caption: HTMLElement;
  private readonly objects = new Map<string, Object3D[]>();
  middle: Point = [0.5, 0.5, 0.5];
  radius = 0.9;

  constructor(
    private readonly stage: Stage,
    readonly title: string,
    large: boolean,
  ) {
    this.place = element("div", { class: "place", role: "application", tabindex: "0" });
    this.place.setAttribute("aria-roledescription", "picture that turns");
    this.place.setAttribute("aria-label", `${title}. Arrow keys turn all pictures, plus and minus zoom, Home goes back.`);
    this.caption = element("figcaption", {});
    this.figure = element("figure", { class: large ? "panel large" : "panel" }, this.place, this.caption);
    this.scene.add(new AmbientLight(0xffffff, 1.6));
  }

  /** What is said below the picture: its title, and more in small. */
  say(more: string, verdict: "" | "good" | "bad" = ""): void {
    const text = `${this.title}|${more}|${verdict}`;
    if (this.caption.dataset.text === text) return;
    this.caption.dataset.text = text;
    const words = element("span", { class: verdict || "quiet" }, more);
    this.caption.replaceChildren(element("b", {}, this.title), words);
  }

  /** Fit a lattice of this shape. */
  fit(shape: Point): void {
    this.middle = shape.map((n) => (n - 1) / 2) as Point;
    this.radius = Math.hypot(...this.middle) * 1.05;
  }

  private put(name: string, ...objects: Object3D[]): void {
    for (const old of this.objects.get(name) ?? []) {
      this.scene.remove(old);
      if (old instanceof InstancedMesh) old.dispose();
      else if (old instanceof Mesh) old.geometry.dispose();
    }
    this.objects.set(name, objects);
    for (const one of objects) this.scene.add(one);
  }

  /** Show these triangles: one colour from outside, another from inside. */
  surface(name: string, given: Triangles | null, clear = false): void {
    if (!given || given.vertices === 0) return this.put(name);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(given.positions.slice(0, 3 * given.vertices), 3));
    if (given.index) geometry.setIndex(new BufferAttribute(given.index.slice(0, given.indices), 1));
    if (given.normals)
      geometry.setAttribute("normal", new BufferAttribute(given.normals.slice(0, 3 * given.vertices), 3));
    else geometry.computeVertexNormals();
    const { front, back, clearFront, clearBack } = this.stage.palette;
    const sides = clear ? [clearBack, clearFront] : [back, front];
    this.put(name, ...sides.map((material) => new Mesh(geometry, material)));
  }

  /** Show these segments. */
  lines(kind: LineKind, segments: readonly (readonly [Point, Point])[]): void {
    if (!segments.length) return this.put(`lines ${kind}`);
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(segments.flatMap(([a, b]) => [...a, ...b]));
    const object = new LineSegments2(geometry, this.stage.palette.lines.get(kind));
    if (LINES[kind][2]) object.computeLineDistances();
    object.renderOrder = kind === "lattice" ? 0 : 1;
    this.put(`lines ${kind}`, object);
  }

  /** Show small bodies at these points. */
  marks(kind: MarkKind, points: readonly Point[], scale = 1): void {
    if (!points.length) return this.put(`mark ${kind}`);
    const [, shape, radius] = MARKS[kind];
    const material = this.stage.palette.marks.get(kind)!;
    const made = new InstancedMesh(shape === "ball" ? BALL : OCTAHEDRON, material, points.length);
    const matrix = new Matrix4();
    const size = radius * scale;
    points.forEach((p, i) => made.setMatrixAt(i, matrix.makeScale(size, size, size).setPosition(...p)));
    this.put(`mark ${kind}`, made);
  }

  /** Light up the cells with these lowest corners. */
  boxes(cells: readonly Point[]): void {
    if (!cells.length) return this.put("boxes");
    const made = new InstancedMesh(BOX, this.stage.palette.box, cells.length);
    const matrix = new Matrix4();
    cells.forEach(([i, j, k], n) => made.setMatrixAt(n, matrix.makeTranslation(i + 0.5, j + 0.5, k + 0.5)));
    made.renderOrder = 2;
    this.put("boxes", made);
  }

  dispose(): void {
    for (const name of [...this.objects.keys()]) this.put(name);
    this.figure.remove();
  }
}

/** The edges of a lattice, or of the box round it. */
export function lattice(shape: Point, whole = true): [Point, Point][] {
  const steps = whole ? [1, 1, 1] : shape.map((n) => n - 1);
  const found: [Point, Point][] = [];
  for (let i = 0; i < shape[0]; i += steps[0])
    for (let j = 0; j < shape[1]; j += steps[1])
      for (let k = 0; k < shape[2]; k += steps[2])
        for (let axis = 0; axis < 3; axis++) {
          const end: Point = [i, j, k];
          end[axis] += steps[axis];
          if (end[axis] < shape[axis]) found.push([[i, j, k], end]);
        }
  return found;
}

export class Stage {
  readonly palette = new Palette();
  readonly view: View = { ...START };
  panels: Panel[] = [];
  /** Milliseconds of script that each of the last frames took, and what of it was the update. */
  readonly spent: { frame: number; update: number }[] = [];
  update: () => void = () => {};
  /** Called when the reader turned the pictures. */
  turned: () => void = () => {};
  /** Called after each frame, to move what stands on a panel. */
  placed: () => void = () => {};
  private readonly renderer: WebGLRenderer | null = null;
  /** Why nothing is drawn, where the browser has no WebGL. */
  readonly failed: string = "";
  private readonly canvas: HTMLCanvasElement;
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 1000);
  private readonly lamp = new DirectionalLight(0xffffff, 2.2);
  private waiting = false;
  private stale = false;
  private size = "";

  constructor(readonly host: HTMLElement) {
    this.canvas = element("canvas", { class: "canvas", "aria-hidden": "true" });
    document.body.append(this.canvas);
    try {
      this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true });
    } catch (error) {
      this.failed = String(error);
    }
    this.camera.up.set(0, 0, 1);
    new ResizeObserver(() => this.ask()).observe(host);
    for (const name of ["scroll", "resize"]) addEventListener(name, () => this.ask(), { passive: true });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette.paint();
      this.ask();
    });
  }

  /** Add a panel. */
  panel(title: string, large = false): Panel {
    const made = new Panel(this, title, large);
    this.host.append(made.figure);
    this.panels.push(made);
    this.listen(made.place);
    return made;
  }

  clear(): void {
    for (const panel of this.panels) panel.dispose();
    this.panels = [];
    this.placed = () => {};
  }

  /** Draw soon; with `anew` after an update of what is shown. */
  ask(anew = false): void {
    this.stale ||= anew;
    if (!this.waiting) requestAnimationFrame(() => this.frame());
    this.waiting = true;
  }

  /** Turn all pictures. */
  turn(aside: number, over: number): void {
    this.view.turn = (this.view.turn + aside) % 360;
    this.view.tilt = Math.max(-89.9, Math.min(89.9, this.view.tilt + over));
    this.turned();
    this.ask();
  }

  zoom(times: number): void {
    this.view.zoom = Math.max(0.5, Math.min(8, this.view.zoom * times));
    this.turned();
    this.ask();
  }

  home(): void {
    Object.assign(this.view, START);
    this.turned();
    this.ask();
  }

  /** Where a point of a panel stands in its place, in pixels; and how far from the eye. */
  project(panel: Panel, point: Point): [number, number, number] {
    this.aim(panel);
    const p = new Vector3(...point).project(this.camera);
    return [((p.x + 1) / 2) * panel.place.clientWidth, ((1 - p.y) / 2) * panel.place.clientHeight, p.z];
  }

  private aim(panel: Panel): void {
    const { turn, tilt, zoom } = this.view;
    const [a, b] = [turn * RADIANS, tilt * RADIANS];
    const width = panel.place.clientWidth;
    const height = panel.place.clientHeight;
    const half = Math.sin((FIELD_OF_VIEW / 2) * RADIANS) * Math.min(1, width / height);
    const away = (panel.radius * 1.12) / half / zoom;
    const eye = new Vector3(Math.cos(b) * Math.cos(a), Math.cos(b) * Math.sin(a), Math.sin(b));
    const middle = new Vector3(...panel.middle);
    this.camera.position.copy(eye).multiplyScalar(away).add(middle);
    this.camera.lookAt(middle);
    this.camera.aspect = width / height;
    this.camera.near = away / 50;
    this.camera.far = away * 3;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    // The light stands a little above the eye's left.
    this.lamp.position.copy(new Vector3(-0.5, 0.7, 1).applyQuaternion(this.camera.quaternion)).add(middle);
    this.lamp.target.position.copy(middle);
    this.lamp.target.updateMatrixWorld();
  }

  private frame(): void {
    const begun = performance.now();
    this.waiting = false;
    if (this.stale) this.update();
    this.stale = false;
    const updated = performance.now();
    const { renderer } = this;
    // An undrawn canvas is black in some browsers, and it lies over the page.
    this.canvas.style.display = renderer && this.panels.length ? "block" : "none";
    if (renderer && this.panels.length) this.draw(renderer);
    this.placed();
    this.spent.push({ frame: performance.now() - begun, update: updated - begun });
    if (this.spent.length > 240) this.spent.shift();
  }

  /** Draw every panel in sight. */
  private draw(renderer: WebGLRenderer): void {
    this.resize(renderer);
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    const { height } = renderer.getSize(new Vector2());
    for (const panel of this.panels) {
      const box = panel.place.getBoundingClientRect();
      if (box.bottom < 0 || box.top > height || !box.width) continue;
      this.aim(panel);
      panel.scene.add(this.lamp, this.lamp.target);
      renderer.setViewport(box.left, height - box.bottom, box.width, box.height);
      renderer.setScissor(box.left, height - box.bottom, box.width, box.height);
      renderer.render(panel.scene, this.camera);
    }
  }

  private resize(renderer: WebGLRenderer): void {
    const [width, height] = [document.documentElement.clientWidth, innerHeight];
    this.canvas.style.transform = `translate(${scrollX}px, ${scrollY}px)`;
    const ratio = Math.min(devicePixelRatio, 2, Math.sqrt(MOST_PIXELS / Math.max(1, width * height)));
    const size = `${width} ${height} ${ratio}`;
    if (size === this.size || !width || !height) return;
    this.size = size;
    renderer.setPixelRatio(ratio);
    renderer.setSize(width, height);
  }

  private listen(place: HTMLElement): void {
    const fingers = new Map<number, { x: number; y: number }>();
    let spread = 0;
    place.addEventListener("pointerdown", (event) => {
      if (event.target !== place) return;
      place.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      spread = 0;
    });
    place.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (fingers.size === 1) this.turn(-dx / 2, dy / 2);
      if (fingers.size === 2) {
        const [a, b] = [...fingers.values()];
        const wide = Math.hypot(a.x - b.x, a.y - b.y);
        if (spread) this.zoom(wide / spread);
        spread = wide;
      }
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const)
      place.addEventListener(name, (event) => fingers.delete((event as PointerEvent).pointerId));
    const steps: Record<string, () => void> = {
      ArrowLeft: () => this.turn(8, 0),
      ArrowRight: () => this.turn(-8, 0),
      ArrowUp: () => this.turn(0, -8),
      ArrowDown: () => this.turn(0, 8),
      "+": () => this.zoom(1.2),
      "=": () => this.zoom(1.2),
      "-": () => this.zoom(1 / 1.2),
      Home: () => this.home(),
    };
    place.addEventListener("keydown", (event) => {
      if (event.target !== place || event.ctrlKey || event.metaKey || event.altKey) return;
      const step = steps[event.key];
      if (!step) return;
      step();
      event.preventDefault();
    });
  }
}
