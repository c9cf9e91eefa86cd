"use strict";
// Figures are read off and zoomed. A mark of a drawing carries its reading as a title; a frame carries its axes, and
// the lines drawn behind it in the file belong to it.

const SVG = "http://www.w3.org/2000/svg";
// Reach [px] of a pointer and of a finger; most magnification.
const REACH = { mouse: 14, touch: 28 }, MOST = 20;

const tip = document.createElement("output");
tip.className = "tip";
tip.hidden = true;

class Axis {
  constructor(text) {
    const [low, high, from, to] = text.split(" ").map(Number);
    Object.assign(this, { low, high, from, to, isLogarithmic: text.endsWith("log") });
  }

  value(pixel) {
    const part = (pixel - this.from) / (this.to - this.from);
    return this.isLogarithmic ? this.low * (this.high / this.low) ** part : this.low + part * (this.high - this.low);
  }

  pixel(value) {
    const part = this.isLogarithmic ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return this.from + part * (this.to - this.from);
  }

  // With as many digits as a pixel resolves.
  written(pixel) {
    const value = this.value(pixel), step = Math.abs(this.value(pixel + 0.5) - value) || 1;
    const decimals = Math.min(Math.max(0, Math.ceil(-Math.log10(step))), 12);
    return fixed(value, decimals);
  }

  // Round values between two pixels, at most so many.
  ticks(one, other, most) {
    const ends = [this.value(one), this.value(other)].sort((a, b) => a - b);
    return ticks(ends, most).map(([value, text]) => [this.pixel(value), text]);
  }
}

// "Drawbar pull F_{DP} [N]" as name and unit.
function nameAndUnit(text) {
  const plain = text.replace(/_\{(\w*)\}/g, (_, index) => index && `_${index}`);
  const [, name, unit] = plain.match(/^(.*?) \[([^\]]*)\]/) ?? [null, plain, ""];
  return { name, unit: unit === "-" ? "" : ` ${unit}` };
}

// Vertices of a line in its drawing.
const vertices = path => [...path.getAttribute("d").matchAll(/[ML](\S+) ([^MLZ]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);

class Drawing {
  constructor(box, svg) {
    Object.assign(this, { box, svg, whole: svg.getAttribute("viewBox").split(/[ ,]+/).map(Number) });
    this.view = this.whole;
    this.marks = [];
    this.frames = [];
    this.listen();
  }

  // Finds marks and lines, once the drawing is in sight and used.
  prepare() {
    if (this.over) return;
    const { svg } = this;
    this.over = svg.appendChild(document.createElementNS(SVG, "g"));
    this.marks = [...svg.querySelectorAll("title")].filter(title => title.parentNode !== svg).map(title => this.mark(title));
    this.marks.sort((a, b) => a.x - b.x || a.y - b.y);
    for (const part of svg.querySelectorAll("[data-x], [data-line], [data-axis]")) this.add(part);
    this.radii = [...svg.querySelectorAll("circle")].map(circle => [circle, Number(circle.getAttribute("r"))]);
  }

  // The reading is taken out of the drawing, so that the browser does not show it a second time.
  mark(title) {
    const shape = title.parentNode, { x, y, width, height } = shape.getBBox(), reading = title.textContent;
    title.remove();
    shape.dataset.reading = reading;
    return { x: x + width / 2, y: y + height / 2, width, height, reading };
  }

  add(part) {
    if (part.dataset.axis !== undefined) {
      const { x, y, width } = part.getBBox();
      const above = this.frames.filter(({ x: { from, to } }) => from < x + width && x < to);
      for (const frame of above) if (!frame.across) Object.assign(frame, { across: nameAndUnit(part.textContent), below: y });
    } else if (part.dataset.line !== undefined) {
      // Parts of one name are one line: the stretches between gaps, the bounds of a band.
      const { lines } = this.frames.at(-1), name = part.dataset.line, known = lines.find(line => line.name === name);
      if (known) known.points.push(...vertices(part)); else lines.push({ name, points: vertices(part) });
    } else {
      const { x, y, name } = part.dataset;
      // In a row of frames the first has the header.
      const row = this.frames.find(frame => frame.row === y);
      this.frames.push({ x: new Axis(x), y: new Axis(y), row: y, up: name || !row ? nameAndUnit(name) : row.up, lines: [] });
    }
  }

  // Place in the drawing of a place in the window, and pixels of the window in one of the drawing.
  place({ clientX, clientY }) {
    const matrix = this.svg.getScreenCTM(), { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
    return { x, y, scale: matrix.a };
  }

  read(event) {
    const at = this.place(event), reach = REACH[event.pointerType === "touch" ? "touch" : "mouse"] / at.scale;
    const beyond = mark => Math.hypot(Math.max(0, Math.abs(mark.x - at.x) - mark.width / 2), Math.max(0, Math.abs(mark.y - at.y) - mark.height / 2));
    const near = this.marks.map(mark => [beyond(mark), Math.hypot(mark.x - at.x, mark.y - at.y), mark]).filter(([far]) => far < reach);
    near.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    if (near.length) return this.show(near[0][2]);
    const frame = this.frames.find(({ x, y, lines }) => lines.length && x.from <= at.x && at.x <= x.to && y.to <= at.y && at.y <= y.from);
    return frame ? this.follow(frame, at.x) : this.hide();
  }

  // Reads the lines of a frame at the vertices next to a place across.
  follow(frame, across) {
    const read = frame.lines.map(line => {
      const nearest = line.points.reduce((best, [x]) => Math.abs(x - across) < Math.abs(best - across) ? x : best, Infinity);
      const there = line.points.filter(([x]) => Math.abs(x - nearest) < 0.6).map(([, y]) => y);
      return { ...line, nearest, ends: [Math.max(...there), Math.min(...there)] };
    }).filter(({ nearest }) => Math.abs(nearest - across) < 12);
    if (!read.length) return this.hide();
    const at = read[0].nearest, { x, y, up } = frame, { name, unit } = frame.across ?? { name: "", unit: "" };
    const rows = read.map(({ name, ends }) => {
      const [low, high] = ends.map(end => y.written(end));
      return `${name || up.name} ${low === high ? low : `${low} to ${high}`}${up.unit}`;
    });
    const { from, to } = y, spots = read.map(({ ends }) => [at, (ends[0] + ends[1]) / 2]);
    this.show({ x: at, y: Math.min(...spots.map(([, y]) => y)), width: 0, height: 0, spots, from, to,
      reading: [`${name} ${x.written(at)}${unit}`.trim(), ...rows].join("\n") }, frame);
  }

  show(mark, frame) {
    this.shown = mark;
    this.frame = frame;
    this.over.replaceChildren();
    const scale = this.svg.getScreenCTM().a;
    if (mark.from !== undefined) this.draw("path", { class: "cursor", d: `M${mark.x} ${mark.from}V${mark.to}` });
    for (const [cx, cy] of mark.spots ?? [[mark.x, mark.y]]) this.draw("circle", { class: "spot", cx, cy, r: 7 / scale });
    tip.textContent = mark.reading;
    tip.hidden = false;
    const { x, y } = new DOMPoint(mark.x, mark.y).matrixTransform(this.svg.getScreenCTM());
    const { width, height } = tip.getBoundingClientRect(), room = document.documentElement.clientWidth - width - 6;
    tip.style.left = `${Math.max(6, Math.min(x + 14, room))}px`;
    tip.style.top = `${y - height - 14 > 0 ? y - height - 14 : y + 18}px`;
  }

  hide() {
    this.over.replaceChildren();
    tip.hidden = true;
    this.shown = undefined;
  }

  draw(name, attributes, text = "") {
    const part = document.createElementNS(SVG, name);
    for (const key in attributes) part.setAttribute(key, attributes[key]);
    part.textContent = text;
    return this.over.appendChild(part);
  }

  // Shows a part of the drawing, in its proportions and within it.
  look([x, y, width]) {
    const [, , most, high] = this.whole, wide = Math.min(Math.max(width, most / MOST), most), tall = wide * high / most;
    this.view = [Math.min(Math.max(x, 0), most - wide), Math.min(Math.max(y, 0), high - tall), wide, tall];
    this.svg.setAttribute("viewBox", this.view.join(" "));
    for (const [circle, radius] of this.radii) circle.setAttribute("r", radius * Math.sqrt(wide / most));
    this.box.classList.toggle("zoomed", wide < most);
    this.hide();
    this.label();
  }

  // Ticks of the frames in view, along the edges of the view.
  label() {
    this.ticks?.remove();
    const [left, top, width, height] = this.view, scale = width / this.whole[2];
    if (scale >= 1) return;
    this.ticks = this.svg.insertBefore(document.createElementNS(SVG, "g"), this.over);
    const add = (x, y, text, anchor) => {
      const label = document.createElementNS(SVG, "text");
      for (const [key, value] of Object.entries({ x, y, class: "tick", "font-size": 14 * scale, "text-anchor": anchor })) label.setAttribute(key, value);
      label.textContent = text;
      this.ticks.append(label);
    };
    for (const { x, y } of this.frames) {
      const [from, to] = [Math.max(x.from, left), Math.min(x.to, left + width)], [low, high] = [Math.min(y.from, top + height), Math.max(y.to, top)];
      if (to - from < 60 * scale || low - high < 40 * scale) continue;
      for (const [at, text] of x.ticks(from, to, (to - from) / (90 * scale))) add(at, low - 5 * scale, text, "middle");
      for (const [at, text] of y.ticks(low, high, (low - high) / (40 * scale))) if (low - at > 20 * scale) add(from + 4 * scale, at + 5 * scale, text, "start");
    }
  }

  zoom(factor, { x, y }) {
    const [left, top, width] = this.view;
    this.look([x - factor * (x - left), y - factor * (y - top), factor * width]);
  }

  listen() {
    const { box, svg } = this, on = (name, act) => svg.addEventListener(name, event => { this.prepare(); act(event); }, { passive: false });
    on("pointerenter", () => {});
    on("pointerdown", event => { if (event.pointerType === "touch") this.read(event); else if (event.button === 0) this.from = this.place(event); });
    on("pointermove", event => { if (event.pointerType === "touch") return; if (this.from && event.buttons) this.select(event); else this.read(event); });
    on("pointerup", event => this.release(event));
    on("pointerleave", event => { if (event.pointerType !== "touch") { this.from = undefined; this.hide(); } });
    on("dblclick", () => this.look(this.whole));
    on("wheel", event => {
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== box) return;
      event.preventDefault();
      this.zoom(2 ** Math.min(Math.max(event.deltaY / 200, -1), 1), this.place(event));
    });
    box.addEventListener("keydown", event => { this.prepare(); this.key(event); });
    box.addEventListener("blur", () => { if (this.over) this.hide(); });
  }

  select(event) {
    const { x, y } = this.place(event), { from } = this;
    this.hide();
    this.draw("rect", { class: "selection", x: Math.min(x, from.x), y: Math.min(y, from.y), width: Math.abs(x - from.x), height: Math.abs(y - from.y) });
  }

  release(event) {
    const { from } = this, { x, y, scale } = this.place(event);
    this.from = undefined;
    if (!from || event.pointerType === "touch") return;
    this.hide();
    const [, , most, high] = this.whole, wide = Math.abs(x - from.x), tall = Math.abs(y - from.y);
    if (Math.max(wide, tall) * scale < 8) return;
    const width = Math.max(wide, tall * most / high);
    this.look([(x + from.x - width) / 2, (y + from.y - width * high / most) / 2, width]);
  }

  key(event) {
    const centre = { x: this.view[0] + this.view[2] / 2, y: this.view[1] + this.view[3] / 2 };
    const acts = {
      ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1), Escape: () => this.hide(),
      "+": () => this.zoom(0.5, this.shown ?? centre), "=": () => this.zoom(0.5, this.shown ?? centre),
      "-": () => this.zoom(2, this.shown ?? centre), 0: () => this.look(this.whole),
    };
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    acts[event.key]();
  }

  // To the next mark, or a hundredth along a frame with lines.
  step(by) {
    if (this.marks.length) {
      const place = this.marks.indexOf(this.shown), next = place < 0 ? (by > 0 ? 0 : this.marks.length - 1) : place + by;
      return this.show(this.marks[Math.min(Math.max(next, 0), this.marks.length - 1)]);
    }
    const frame = this.frame ?? this.frames.find(({ lines }) => lines.length);
    if (!frame) return;
    const { from, to } = frame.x, at = this.shown?.x ?? from;
    this.follow(frame, Math.min(Math.max(at + by * (to - from) / 100, from), to));
  }
}

const drawings = [...document.querySelectorAll(".drawing")].flatMap(box =>
  [...box.querySelectorAll("svg")].filter(svg => !svg.ownerSVGElement).map(svg => new Drawing(box, svg)));
if (drawings.length) document.body.append(tip);
addEventListener("beforeprint", () => drawings.forEach(drawing => { if (drawing.over) drawing.look(drawing.whole); }));
