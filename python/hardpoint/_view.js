// Sliders, curves and mechanism of a study, for notebooks. Positions and curves come from Python.
const SVG = "http://www.w3.org/2000/svg";
const COLOURS = { arm: "#1f77b4", link: "#2ca02c", strut: "#9467bd", spring: "#8c564b", rocker: "#e377c2", knuckle: "#7f7f7f" };

function add(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

function html(parent, name, style, text) {
  const element = document.createElement(name);
  element.style.cssText = style;
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

function extent(values) {
  const known = values.filter((v) => v !== null);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const margin = high > low ? 0.05 * (high - low) : 1;
  return known.length ? [low - margin, high + margin] : [0, 1];
}

function plot(parent, name, nominal, curves) {
  const [w, h] = [320, 190];
  const svg = add(parent, "svg", { width: w, height: h, "font-family": "sans-serif", "font-size": 11 });
  const [x0, x1] = extent(nominal.x);
  const [y0, y1] = extent([...nominal.y[name], ...curves.y[name]]);
  const sx = (x) => 45 + ((x - x0) / (x1 - x0)) * (w - 55);
  const sy = (y) => h - 32 - ((y - y0) / (y1 - y0)) * (h - 55);
  add(svg, "rect", { x: 45, y: 23, width: w - 55, height: h - 55, fill: "none", stroke: "#999" });
  add(svg, "text", { x: 45, y: 15 }, name);
  add(svg, "text", { x: w / 2, y: h - 4, "text-anchor": "middle" }, nominal.over);
  for (const y of [y0, y1]) add(svg, "text", { x: 42, y: sy(y) + 4, "text-anchor": "end" }, y.toPrecision(3));
  for (const x of [x0, x1]) add(svg, "text", { x: sx(x), y: h - 18, "text-anchor": "middle" }, x.toPrecision(3));
  for (const [of, dash, colour] of [[nominal, "4 3", "#999"], [curves, "", "#1f77b4"]]) {
    let path = "";
    let pen = "M";
    const way = Math.sign(of.x[1] - of.x[0]);
    of.x.forEach((x, k) => {
      const y = of.y[name][k];
      if (y !== null) path += `${pen}${sx(x)} ${sy(y)}`;
      // Each rack displacement after the first one begins a new line: there, the values of the drive turn back.
      pen = y === null || (k + 1 < of.x.length && way * (of.x[k + 1] - x) < 0) ? "M" : "L";
    });
    add(svg, "path", { d: path, fill: "none", stroke: colour, "stroke-dasharray": dash });
  }
}

function mechanism(svg, drawing, frame, turn) {
  svg.replaceChildren();
  const pose = drawing.frames[frame] && drawing.frames[frame].pose.Ok;
  if (!pose) return;
  const [sx, sy, sz] = drawing.scene.signs;
  const all = drawing.frames.filter((f) => f.pose.Ok).flatMap((f) => f.pose.Ok.points);
  const middle = [0, 1, 2].map((k) => (Math.min(...all.map((p) => p[k])) + Math.max(...all.map((p) => p[k]))) / 2);
  const size = Math.max(...all.map((p) => Math.hypot(...p.map((c, k) => c - middle[k]))));
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const flat = (p) => {
    const [x, y, z] = [(p[0] - middle[0]) * sx, (p[1] - middle[1]) * sy, (p[2] - middle[2]) * sz];
    return [160 + (150 / size) * (y * c - x * s), 190 - (150 / size) * (z - 0.35 * (x * c + y * s))];
  };
  for (const body of drawing.scene.bodies)
    for (const line of body.lines) {
      const points = line.map((k) => flat(pose.points[k]).join(",")).join(" ");
      add(svg, "polyline", { points, fill: "none", stroke: COLOURS[body.kind] || "#444", "stroke-width": 3 });
    }
  pose.points.forEach((p, k) => {
    const [x, y] = flat(p);
    add(add(svg, "circle", { cx: x, cy: y, r: 3, fill: "#333" }), "title", {}, drawing.scene.points[k]);
  });
}

function render({ model, el }) {
  const box = html(el, "div", "display:flex;flex-wrap:wrap;gap:12px;align-items:flex-start");
  const sliders = html(box, "div", "font:12px sans-serif");
  const left = html(box, "div", "");
  const svg = add(left, "svg", { width: 320, height: 380 });
  const at = html(left, "div", "font:12px sans-serif", "motion ");
  const station = html(at, "input", "width:100px");
  at.append(" view ");
  const turned = html(at, "input", "width:100px");
  const right = html(box, "div", "display:grid;grid-template-columns:repeat(2,320px)");
  const note = html(el, "div", "color:#b00;font:12px sans-serif");
  Object.assign(station, { type: "range", min: 0, step: 1 });
  Object.assign(turned, { type: "range", min: -1.6, max: 1.6, step: 0.02, value: 0.5 });

  const picture = () => mechanism(svg, model.get("drawing"), Number(station.value), Number(turned.value));
  const curves = () => {
    right.replaceChildren();
    const [nominal, moved] = [model.get("nominal"), model.get("curves")];
    for (const name of Object.keys(nominal.y)) plot(right, name, nominal, moved);
  };
  model.get("variables").forEach((name, k) => {
    const row = html(sliders, "div", "");
    html(row, "label", "display:block", name);
    const slider = html(row, "input", "width:180px");
    const [low, high] = model.get("bounds")[k];
    Object.assign(slider, { type: "range", min: low, max: high, step: (high - low) / 400, value: model.get("offsets")[k] });
    const value = html(row, "span", "", Number(slider.value).toPrecision(4));
    slider.addEventListener("input", () => {
      const offsets = [...model.get("offsets")];
      offsets[k] = Number(slider.value);
      model.set("offsets", offsets);
      model.save_changes();
    });
    model.on("change:offsets", () => {
      slider.value = model.get("offsets")[k];
      value.textContent = model.get("offsets")[k].toPrecision(4);
    });
  });
  const frames = model.get("drawing").frames.length;
  station.max = frames - 1;
  station.value = Math.floor(frames / 2);
  station.addEventListener("input", picture);
  turned.addEventListener("input", picture);
  model.on("change:drawing", picture);
  model.on("change:curves", curves);
  model.on("change:error", () => (note.textContent = model.get("error")));
  picture();
  curves();
}

export default { render };
