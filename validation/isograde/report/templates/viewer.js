// @ts-check
/*
A failing case that can be turned, measured by eye, and taken along.

The page holds for each failure a static picture, and beside it the case as data (`viewer.py`).
Where scripts run, the picture of a case in space is drawn again from the data and turns: with a
mouse or a finger, by the arrow keys, by the buttons. All answers to one case turn together. The
classes are those of the static picture, so the page's style sheet colours both; print shows the
static one.

A position p of the lattice stands in the picture at
  right   x =  p . (-sin turn, cos turn, 0)
  eye     d =  p . (cos tilt cos turn, cos tilt sin turn, sin tilt)
  down    y = -p . (eye x right)
from the centre, times a scale. Parts are painted from far to near, by the depth d of their middle.
*/

/**
 * @typedef {[number, number, number]} Point
 * @typedef {object} View
 * @property {number} turn about axis 2, in degrees
 * @property {number} tilt of the eye above the horizon, in degrees
 * @property {number} zoom 1 where all of the lattice is in view
 * @property {Point} centre what stands in the middle, in index coordinates
 *
 * @typedef {object} Answer
 * @property {string} caption
 * @property {number[]} points in index coordinates, all in one list
 * @property {number[][]} rows the simplices, by their points
 * @property {number} left_out how many simplices are not here
 * @property {[string, ...number[]][]} marks kinds, each with one point, two, or a triangle
 *
 * @typedef {object} Case
 * @property {string} name
 * @property {string} reason
 * @property {number[]} shape
 * @property {(number | string)[]} values none of a large field; as text where JSON has no number
 * @property {number[]} inside for each sample, 1 where it is inside all components
 * @property {(number | string)[]} isovalues
 * @property {number[]} spacing
 * @property {number[]} origin
 * @property {string} dtype
 * @property {Answer[]} answers
 * @property {string} explorer a link, to which the values are added, or nothing
 */

const SIZE = 360, ROOM = 26;
const START = { turn: -62, tilt: 24 };
const STEP = 10, ZOOM = 1.25, ASIDE = 26;
// Show about so many cells round a fault.
const CELLS = 4;
// Write values beside samples from the start, and on demand, up to so many samples.
const LABELLED = 12, LABELS = 150;
const NEAR = 1e6;
const MARKS = {
  gap: ["open edge inside the lattice", "open edges inside the lattice"],
  crowd: ["edge of more than two triangles", "edges of more than two triangles"],
  twice: ["triangle that is there twice", "triangles that are there twice"],
  flat: ["triangle without area", "triangles without area"],
  unused: ["vertex that no triangle uses", "vertices that no triangle uses"],
  level: ["triangle that lies flat in a face", "triangles that lie flat in a face"],
  spot: ["loose end", "loose ends"],
};
const CURVES = { ...MARKS, crowd: ["point of more than two segments", "points of more than two segments"],
  unused: ["vertex that no segment uses", "vertices that no segment uses"] };

// --- A field as source text ----------------------------------------------------------------------

/** The names of number types in C and Rust. @type {Record<string, Record<"c" | "rust", string>>} */
const TYPES = {
  float64: { c: "double", rust: "f64" }, float32: { c: "float", rust: "f32" },
  float16: { c: "float", rust: "f32" }, bool: { c: "uint8_t", rust: "u8" },
  ...Object.fromEntries([8, 16, 32, 64].flatMap((bits) => [
    [`int${bits}`, { c: `int${bits}_t`, rust: `i${bits}` }],
    [`uint${bits}`, { c: `uint${bits}_t`, rust: `u${bits}` }],
  ])),
};

/** The name of NumPy's number type without its byte order: ">f8" is float64. @param {string} dtype */
const plain = (dtype) => {
  const short = /^[<>=|]?([fiu])(\d)$/.exec(dtype);
  const kind = { f: "float", i: "int", u: "uint" };
  return short ? kind[/** @type {"f" | "i" | "u"} */ (short[1])] + 8 * Number(short[2]) : dtype;
};

/** A number as text that has its type. @param {number | string} value @param {string} type
 * @param {"python" | "c" | "rust"} language */
const literal = (value, type, language) => {
  const text = String(value), real = type.startsWith("float");
  const single = real && type !== "float64" && language === "c" ? "f" : "";
  if (!real) {
    if (type === "bool" && language !== "python") return text === "true" ? "1" : "0";
    if (type === "bool") return text === "true" ? "True" : "False";
    if (language !== "c" || !type.endsWith("64")) return text;
    if (type === "uint64") return `${text}ULL`;
    return text === "-9223372036854775808" ? "INT64_MIN" : `${text}LL`;
  }
  const named = /^(-?)(NaN|Infinity)$/.exec(text);
  if (!named) return (/[.e]/.test(text) ? text : `${text}.0`) + single;
  const [, sign, word] = named, infinite = word === "Infinity";
  if (language === "python") return infinite ? `${sign}np.inf` : "np.nan";
  if (language === "c") return infinite ? `${sign}INFINITY` : "NAN";
  const rust = type === "float64" ? "f64" : "f32";
  return rust + (infinite ? (sign ? "::NEG_INFINITY" : "::INFINITY") : "::NAN");
};

/** Values nested by shape, in brackets. @param {string[]} values @param {number[]} shape
 * @param {string} open @param {string} close @param {string} indent @returns {string} */
const nested = (values, shape, open, close, indent = "  ") => {
  if (shape.length < 2) return open + values.join(", ") + close;
  const size = values.length / shape[0];
  const parts = Array.from({ length: shape[0] }, (_, i) =>
    nested(values.slice(i * size, (i + 1) * size), shape.slice(1), open, close, `${indent}  `));
  return `${open}\n${parts.map((part) => indent + part).join(",\n")}\n${indent.slice(2)}${close}`;
};

/** The case's field as source text of a language. @param {Case} one @param {string} language */
const written = (one, language) => {
  const type = plain(one.dtype), several = one.isovalues.length > 1;
  const shape = several ? [one.isovalues.length, ...one.shape] : one.shape;
  const said = `${one.name}: shape ${one.shape.join(" x ")}, last index fastest` +
    (several ? `, ${one.isovalues.length} fields` : "");
  if (language === "json") {
    const { name, dtype, spacing, origin, isovalues, values } = one;
    return JSON.stringify({ name, shape: one.shape, dtype, spacing, origin, isovalues, values });
  }
  if (language === "python") {
    const level = one.isovalues.map((x) => literal(x, "float64", "python"));
    return `# ${said}\nimport numpy as np\n\nvalues = np.array(\n  ` +
      nested(one.values.map((x) => literal(x, type, "python")), shape, "[", "]", "    ") +
      `,\n  dtype="${one.dtype}",\n)\n` +
      (several ? `isovalues = (${level.join(", ")})\n` : `isovalue = ${level[0]}\n`) +
      `spacing = (${one.spacing.join(", ")})\norigin = (${one.origin.join(", ")})\n`;
  }
  const { c, rust } = TYPES[type] ?? TYPES.float64;
  if (language === "c") {
    const list = (/** @type {(number | string)[]} */ values) =>
      `{${values.map((x) => literal(x, "float64", "c")).join(", ")}}`;
    return `/* ${said} */\n#include <math.h>\n#include <stdint.h>\n\n` +
      `static const ${c} values${shape.map((n) => `[${n}]`).join("")} = ` +
      `${nested(one.values.map((x) => literal(x, type, "c")), shape, "{", "}")};\n` +
      (several ? `static const double isovalues[${one.isovalues.length}] = ${list(one.isovalues)};\n`
        : `static const double isovalue = ${literal(one.isovalues[0], "float64", "c")};\n`) +
      `static const double spacing[${one.shape.length}] = ${list(one.spacing)};\n` +
      `static const double origin[${one.shape.length}] = ${list(one.origin)};\n`;
  }
  const list = (/** @type {(number | string)[]} */ values) =>
    `[f64; ${values.length}] = [${values.map((x) => literal(x, "float64", "rust")).join(", ")}]`;
  const array = shape.reduceRight((inner, n) => `[${inner}; ${n}]`, rust);
  return `// ${said}\nconst VALUES: ${array} = ` +
    `${nested(one.values.map((x) => literal(x, type, "rust")), shape, "[", "]")};\n` +
    (several ? `const ISOVALUES: ${list(one.isovalues)};\n`
      : `const ISOVALUE: f64 = ${literal(one.isovalues[0], "float64", "rust")};\n`) +
    `const SPACING: ${list(one.spacing)};\nconst ORIGIN: ${list(one.origin)};\n`;
};

// --- The picture ---------------------------------------------------------------------------------

const RADIANS = Math.PI / 180;
/** @param {Point} a @param {Point} b */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {unknown} text */
const escaped = (text) => String(text).replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
/** The index of a sample, from its number in the array. @param {number} number
 * @param {number[]} shape @returns {Point} */
const indexOf = (number, shape) => {
  const index = [0, 0, 0];
  for (let axis = 2; axis >= 0; axis--) {
    index[axis] = number % shape[axis];
    number = Math.floor(number / shape[axis]);
  }
  return /** @type {Point} */ (index);
};

/** The middle of the lattice. @param {Case} one */
const middleOf = (one) => /** @type {Point} */ (one.shape.map((n) => (n - 1) / 2));

/** The SVG inside of one answer, seen from there. @param {Case} one @param {Answer} answer
 * @param {View} view @param {boolean} labels */
const drawn = (one, answer, view, labels) => {
  const { shape } = one, samples = shape[0] * shape[1] * shape[2];
  const turn = view.turn * RADIANS, tilt = view.tilt * RADIANS;
  /** @type {Point} */
  const right = [-Math.sin(turn), Math.cos(turn), 0];
  /** @type {Point} */
  const eye = [Math.cos(tilt) * Math.cos(turn), Math.cos(tilt) * Math.sin(turn), Math.sin(tilt)];
  /** @type {Point} */
  const up = [-Math.sin(tilt) * Math.cos(turn), -Math.sin(tilt) * Math.sin(turn), Math.cos(tilt)];
  const scale = view.zoom * (SIZE / 2 - ROOM) / Math.hypot(...middleOf(one));
  /** @param {Point} p @returns {Point} */
  const place = (p) => {
    const q = /** @type {Point} */ (p.map((x, axis) => x - view.centre[axis]));
    return [SIZE / 2 + scale * dot(q, right), SIZE / 2 - scale * dot(q, up), dot(q, eye)];
  };
  /** @type {[number, string][]} */
  const parts = [];
  /** @param {Point} a @param {Point} b @param {string} kind @param {number} nearer @param {number} short */
  const line = (a, b, kind, nearer = 0, short = 0) => {
    let [ax, ay, ad] = place(a), [bx, by, bd] = place(b);
    const length = Math.hypot(bx - ax, by - ay);
    if (length <= 2 * short) { if (short) return; } else {
      const sx = (bx - ax) * short / length, sy = (by - ay) * short / length;
      ax += sx; ay += sy; bx -= sx; by -= sy;
    }
    parts.push([(ad + bd) / 2 + nearer, `<line class="${kind}" x1="${ax.toFixed(1)}" ` +
      `y1="${ay.toFixed(1)}" x2="${bx.toFixed(1)}" y2="${by.toFixed(1)}"/>`]);
  };
  /** @param {Point} p @param {string} kind @param {number} radius @param {number} nearer @param {string} more */
  const disc = (p, kind, radius, nearer, more = "") => {
    const [x, y, depth] = place(p);
    parts.push([depth + nearer, `<circle class="${kind}" cx="${x.toFixed(1)}" ` +
      `cy="${y.toFixed(1)}" r="${radius}">${more}</circle>`]);
    return [x, y, depth];
  };

  // The lattice, or the box round a large one.
  const detailed = samples <= 400 && one.inside.length > 0;
  const radius = samples <= LABELLED ? 5.5 : 3.6;
  const steps = detailed ? [1, 1, 1] : shape.map((n) => n - 1);
  for (let i = 0; i < shape[0]; i += steps[0])
    for (let j = 0; j < shape[1]; j += steps[1])
      for (let k = 0; k < shape[2]; k += steps[2])
        for (let axis = 0; axis < 3; axis++) {
          const end = /** @type {Point} */ ([i, j, k]);
          end[axis] += steps[axis];
          if (end[axis] < shape[axis]) line([i, j, k], end, "lat", 0, detailed ? radius : 0);
        }

  // Samples, filled where they are inside all components, with their values.
  if (detailed) one.inside.forEach((side, number) => {
    if (!side && samples > 200) return;
    const index = indexOf(number, shape);
    const values = one.isovalues.map((_, m) => one.values[m * samples + number]);
    const told = `sample (${index.join(", ")}): ${values.join(", ")}`;
    const [x, y, depth] = disc(index, side ? "in" : "out", radius, 1e-3, `<title>${told}</title>`);
    if (labels) {
      const text = values.map((value) => typeof value === "number" ? +value.toPrecision(3) : value);
      const left = x > SIZE - 60;
      parts.push([depth + (samples <= LABELLED ? NEAR : 2e-3), `<text class="val" ` +
        `x="${(x + (left ? -8 : 8)).toFixed(1)}" y="${(y - 7).toFixed(1)}"` +
        `${left ? ' text-anchor="end"' : ""}>${text.join(" ")}</text>`]);
    }
  });

  // The mesh: triangles shaded by how they stand to the eye, segments, or points.
  const at = (/** @type {number} */ n) => /** @type {Point} */ (answer.points.slice(3 * n, 3 * n + 3));
  for (const row of answer.rows) {
    const corners = row.map(at);
    if (corners.length === 1) disc(corners[0], "spot", 4, NEAR / 2);
    if (corners.length === 2) line(corners[0], corners[1], "run");
    if (corners.length !== 3) continue;
    const [a, b, c] = corners.map(place);
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const u = corners[1].map((x, i) => x - corners[0][i]), v = corners[2].map((x, i) => x - corners[0][i]);
    const size = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    const square = size ? Math.min(1, Math.abs(area) / (size * scale * scale)) : 0;
    parts.push([(a[2] + b[2] + c[2]) / 3, `<polygon class="${area < 0 ? "front" : "back"}" points="` +
      [a, b, c].map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ") +
      `" fill-opacity="${(0.45 + 0.4 * square).toFixed(2)}"/>`]);
  }

  // What is wrong, over the rest.
  for (const [kind, ...where] of answer.marks) {
    const a = /** @type {Point} */ (where.slice(0, 3)), b = /** @type {Point} */ (where.slice(3, 6));
    if (where.length === 9) {
      const corners = [a, b, /** @type {Point} */ (where.slice(6))].map(place);
      parts.push([Math.max(...corners.map((p) => p[2])) + NEAR / 4, `<polygon class="${kind}" points="` +
        `${corners.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}"/>`]);
    } else if (where.length === 6) line(a, b, kind, kind === "rim" ? 0.05 : NEAR);
    else disc(a, kind, kind === "ring" || kind === "unused" ? 9 : 4, NEAR);
  }
  return parts.sort((a, b) => a[0] - b[0]).map((part) => part[1]).join("");
};

// --- The panel -----------------------------------------------------------------------------------

/** An element with a class and text. @param {string} tag @param {string} kind @param {string} text */
const element = (tag, kind, text = "") => {
  const made = document.createElement(tag);
  made.className = kind;
  made.textContent = text;
  return made;
};

/** What is marked in an answer, in words. @param {Answer} answer */
const counted = (answer) => 
  Object.entries(answer.rows[0]?.length === 2 ? CURVES : MARKS).flatMap(([kind, words]) => {
  // A triangle is marked by its three edges.
  const edges = answer.marks.filter((mark) => mark[0] === kind).length;
  const count = kind === "twice" || kind === "flat" ? edges / 3 : edges;
  return count ? [`${count} ${words[count === 1 ? 0 : 1]}`] : [];
}).join(", ");

/** Make the pictures beside this data turn. @param {HTMLScriptElement} script */
const enliven = (script) => {
  /** @type {Case} */
  const one = JSON.parse(script.textContent ?? "");
  // The pictures stand before the data, with their key between.
  let before = script.previousElementSibling;
  while (before && !before.matches(".pictures, script")) before = before.previousElementSibling;
  const figures = before?.matches(".pictures") ? before.querySelectorAll("figure") : [];
  const turns = one.shape.length === 3 && one.answers.length > 0;
  const samples = one.shape.reduce((product, n) => product * n, 1);
  const start = { ...START, zoom: 1, centre: middleOf(one) };
  const state = { ...start, labels: samples <= LABELLED };
  const bar = element("div", "viewer"), said = element("p", "quiet said");
  said.setAttribute("role", "status");

  const pictures = !turns ? [] : one.answers.flatMap((answer, n) => {
    const still = figures[n]?.querySelector("svg");
    if (!still) return [];
    const live = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    live.setAttribute("class", "pic live");
    live.setAttribute("viewBox", `0 0 ${SIZE} ${SIZE}`);
    live.setAttribute("tabindex", "0");
    live.setAttribute("role", "application");
    live.setAttribute("aria-roledescription", "picture that turns");
    const marked = n === 0 ? counted(answer) : "";
    live.setAttribute("aria-label", `${answer.caption}${marked && `: ${marked}`}. Arrow keys turn it.`);
    still.classList.add("still");
    still.after(live);
    const left = answer.left_out;
    const note = [marked, left && `${answer.rows.length} simplices near the fault; ${left} left out`];
    const words = note.filter(Boolean).join("; ");
    if (words) live.parentElement?.append(element("p", "quiet marked", words));
    return [{ answer, live }];
  });

  // Draw once a frame at most.
  let waiting = false;
  const draw = () => {
    waiting = false;
    for (const { answer, live } of pictures) live.innerHTML = drawn(one, answer, state, state.labels);
  };
  const ask = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  /** Turn by so many degrees. @param {number} aside @param {number} over */
  const turn = (aside, over) => {
    state.turn = (state.turn + aside) % 360;
    state.tilt = Math.max(-90, Math.min(90, state.tilt + over));
    ask();
  };
  /** Go to a view, gliding where that is welcome. @param {View} to */
  const go = (to) => {
    const from = { ...state }, aside = ((to.turn - from.turn) % 360 + 540) % 360 - 180;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches, begun = performance.now();
    const glide = (/** @type {number} */ now) => {
      const t = still ? 1 : Math.min(1, Math.max(0, (now - begun) / 250)), ease = t * (2 - t);
      const between = (/** @type {number} */ a, /** @type {number} */ b) => a + (b - a) * ease;
      state.turn = from.turn + aside * ease;
      state.tilt = between(from.tilt, to.tilt);
      state.zoom = between(from.zoom, to.zoom);
      state.centre = /** @type {Point} */ (from.centre.map((x, axis) => between(x, to.centre[axis])));
      ask();
      if (t < 1) requestAnimationFrame(glide);
    };
    glide(begun);
  };
  const home = () => go(start);
  /** Larger or smaller. @param {number} times */
  const zoom = (times) => {
    state.zoom = Math.max(1, Math.min(40, state.zoom * times));
    ask();
  };
  /** @type {Record<string, () => void>} */
  const KEYS = {
    ArrowLeft: () => turn(STEP, 0), ArrowRight: () => turn(-STEP, 0),
    ArrowUp: () => turn(0, -STEP), ArrowDown: () => turn(0, STEP), Home: home,
    "+": () => zoom(ZOOM), "=": () => zoom(ZOOM), "-": () => zoom(1 / ZOOM),
  };

  for (const { live } of pictures) {
    live.addEventListener("keydown", (event) => {
      const act = event.ctrlKey || event.metaKey || event.altKey ? undefined : KEYS[event.key];
      if (act) { act(); event.preventDefault(); }
    });
    live.addEventListener("pointerdown", (event) => live.setPointerCapture(event.pointerId));
    live.addEventListener("pointermove", (event) => {
      if (live.hasPointerCapture(event.pointerId)) turn(-event.movementX / 2, event.movementY / 2);
    });
  }

  /** A button that does this. @param {string} words @param {() => void} act @param {string} label */
  const button = (words, act, label = "") => {
    const made = /** @type {HTMLButtonElement} */ (element("button", "", words));
    made.type = "button";
    if (label) made.setAttribute("aria-label", label);
    made.addEventListener("click", act);
    bar.append(made);
    return made;
  };
  if (pictures.length) {
    for (const [sign, key, word] of [["←", "ArrowLeft", "left"], ["→", "ArrowRight", "right"],
      ["↑", "ArrowUp", "up"], ["↓", "ArrowDown", "down"]])
      button(sign, KEYS[key], `turn ${word}`);
    button("+", KEYS["+"], "larger");
    button("−", KEYS["-"], "smaller");
    const marks = pictures[0].answer.marks.filter((mark) => mark[0] !== "rim");
    const mark = marks.find((found) => found[0] === "sore-line" || found[0] === "ring") ?? marks[0];
    if (mark) button("to the fault", () => {
      const where = mark.slice(1).map(Number), last = where.length - 3;
      const centre = /** @type {Point} */ ([0, 1, 2].map((a) => (where[a] + where[last + a]) / 2));
      const [x, y, z] = centre.map((at, a) => at - start.centre[a]);
      // Stand on its side, a little aside: along an axis faces are seen edge on. A fault in the
      // middle is seen from everywhere.
      const tilt = Math.atan2(z, Math.hypot(x, y)) / RADIANS;
      const seen = Math.hypot(x, y, z) < 1e-9 ? START
        : { turn: Math.atan2(y, x) / RADIANS + ASIDE, tilt: Math.max(-50, Math.min(50, tilt + ASIDE / 2)) };
      const large = 2 * Math.hypot(...start.centre) / (CELLS * Math.sqrt(3));
      go({ ...seen, ...(large > 1 ? { zoom: large, centre } : { zoom: 1, centre: start.centre }) });
    });
    button("as at first", home);
    if (one.inside.length && samples > LABELLED && samples <= LABELS) {
      const values = button("values", () => {
        state.labels = !state.labels;
        values.setAttribute("aria-pressed", String(state.labels));
        ask();
      });
      values.setAttribute("aria-pressed", "false");
    }
    draw();
  }
  if (one.values.length) {
    bar.append(element("span", "quiet", "copy the array as"));
    for (const language of ["Python", "C", "Rust", "JSON"])
      button(language, async () => {
        const text = written(one, language.toLowerCase());
        try {
          await navigator.clipboard.writeText(text);
          said.textContent = `Copied as ${language}.`;
        } catch {
          // Without a clipboard the text can still be selected.
          said.textContent = "The clipboard is closed to this page; the text, to copy by hand:";
          said.append(element("pre", "", text));
        }
      });
  }
  if (one.explorer) {
    const link = /** @type {HTMLAnchorElement} */ (element("a", "", "open in the explorer"));
    link.href = `${one.explorer}&v=${one.values.join(",")}`;
    bar.append(link);
  }
  bar.append(said);
  script.after(bar);
};

if (typeof document !== "undefined")
  for (const script of document.querySelectorAll("script.turned-case"))
    enliven(/** @type {HTMLScriptElement} */ (script));
