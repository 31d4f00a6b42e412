// A figure of the course: steps of a picture in the plane or in space, drawn into one SVG.
// A slider goes through the steps; dragging, or the arrow keys, turn what stands in space.
((figure) => {
  const film = JSON.parse(figure.querySelector("script[type='application/json']").textContent);
  const svg = figure.querySelector("svg");
  const slider = figure.querySelector("input");
  const caption = figure.querySelector("figcaption");
  const flat = film.flat;
  let [turn, tilt] = film.view;

  // The picture's own coordinates: to the right, up, towards the reader.
  const seen = ([x, y, z]) => {
    if (flat) return [x, y, 0];
    const [c, s, k, l] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
    const [right, away] = [c * x - s * y, s * x + c * y];
    return [right, k * z + l * away, l * z - k * away];
  };
  const shade = (colour, corners) => {
    if (flat) return colour;
    const [a, b, c] = corners;
    const u = b.map((x, i) => x - a[i]);
    const v = c.map((x, i) => x - a[i]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    const light = 0.55 + 0.45 * Math.abs((0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]) / length);
    const parts = [1, 3, 5].map((i) => Math.round(parseInt(colour.slice(i, i + 2), 16) * light));
    return `rgb(${parts})`;
  };
  const element = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text) made.textContent = text;
    return made;
  };

  const draw = () => {
    const step = film.steps[Number(slider.value)];
    const [width, height] = [640, 400];
    const scale = (0.46 * Math.min(width / film.size[0], height / film.size[1])) * 2;
    const points = step.points.map((p) => seen(p.map((x, i) => x - film.centre[i])));
    const at = ([x, y]) => [width / 2 + scale * x, height / 2 - scale * y].map((x) => x.toFixed(1));
    const depth = (corners) => corners.reduce((sum, p) => sum + p[2], 0) / corners.length;
    const drawn = [];
    for (const [corners, colour, alpha] of step.faces) {
      const places = corners.map((i) => points[i]);
      const list = places.map((p) => at(p).join()).join(" ");
      const fill = shade(colour, places);
      drawn.push([depth(places), element("polygon", {
        points: list, fill, "fill-opacity": alpha, stroke: "#333", "stroke-width": flat ? 0 : 0.5,
      })]);
    }
    for (const [i, j, colour, thick, dash] of step.lines) {
      const [[x1, y1], [x2, y2]] = [at(points[i]), at(points[j])];
      drawn.push([depth([points[i], points[j]]) + 0.01, element("line", {
        x1, y1, x2, y2, stroke: colour, "stroke-width": thick, "stroke-linecap": "round",
        "stroke-dasharray": dash ? "5 5" : "none",
      })]);
    }
    for (const [i, colour, radius] of step.dots) {
      const [cx, cy] = at(points[i]);
      drawn.push([points[i][2] + 0.02, element("circle", {
        cx, cy, r: radius, fill: colour, stroke: "#333", "stroke-width": 1,
      })]);
    }
    for (const [i, text] of step.texts) {
      const [x, y] = at(points[i]);
      drawn.push([1e9, element("text", {
        x, y, "font-size": 15, "font-family": "sans-serif", "text-anchor": "middle", fill: "#111",
        stroke: "#fff", "stroke-width": 3, "paint-order": "stroke", dy: -9,
      }, text)]);
    }
    drawn.sort((a, b) => a[0] - b[0]);
    svg.replaceChildren(...drawn.map((one) => one[1]));
    caption.textContent = `${Number(slider.value) + 1} of ${film.steps.length}: ${step.says}`;
    slider.setAttribute("aria-valuetext", caption.textContent);
  };

  slider.addEventListener("input", draw);
  if (!flat) {
    svg.style.cursor = "grab";
    svg.addEventListener("pointerdown", (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      turn += event.movementX / 120;
      tilt = Math.max(-1.5, Math.min(1.5, tilt + event.movementY / 120));
      draw();
    });
    svg.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      if (!step) return;
      [turn, tilt] = [turn + step[0], Math.max(-1.5, Math.min(1.5, tilt + step[1]))];
      event.preventDefault();
      event.stopPropagation();
      draw();
    });
  }
  draw();
})(document.currentScript.parentElement);
