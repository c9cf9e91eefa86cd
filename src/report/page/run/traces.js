// The channels of a run, a panel for each quantity, over one axis of time.

const MARGIN = { left: 58, right: 12, top: 6, bottom: 6, footer: 40 };

class Trace {
  constructor(parent, about, series) {
    this.about = about;
    this.series = series;
    const panel = html(parent, "div", "run-panel"), head = html(panel, "div", "run-head");
    html(head, "span", "run-name", about.name + (about.unit ? ` [${about.unit}]` : ""));
    this.values = series.map(one => {
      const value = html(head, "span", `run-value c${one.colour}`);
      if (one.symbol) value.append(...symbol(one.symbol), " ");
      value.title = one.channel;
      return html(value, "output");
    });
    if (about.command) html(head, "span", "run-command", `${about.command.name} ${written(about.command.value)}`);
    this.drawing = svg(panel, "svg", { role: "img", "aria-label": `${about.name} over time` });
  }

  // Draws the lines over the times of a view.
  draw(view, width, height, isLast) {
    const { left, right, top, bottom, footer } = MARGIN;
    this.drawing.replaceChildren();
    const total = height + top + (isLast ? footer : bottom);
    this.drawing.setAttribute("viewBox", `0 0 ${width} ${total}`);
    this.drawing.style.height = `${total}px`;
    const lines = this.series.map(one => [...one.points(view, width - left - right)]);
    const range = this.range(lines), floor = top + height;
    this.x = time => left + (time - view[0]) / (view[1] - view[0]) * (width - left - right);
    this.y = value => floor - (value - range[0]) / (range[1] - range[0]) * height;
    for (const [value, text] of ticks(range, Math.max(height / 21, 1))) {
      svg(this.drawing, "path", { class: "grid", d: `M${left} ${this.y(value)}H${width - right}` });
      svg(this.drawing, "text", { x: left - 6, y: this.y(value) + 4, "text-anchor": "end" }, text);
    }
    for (const [time, text] of ticks(view, Math.max((width - left - right) / 80, 1))) {
      svg(this.drawing, "path", { class: "grid", d: `M${this.x(time)} ${top}V${floor}` });
      if (isLast) svg(this.drawing, "text", { x: this.x(time), y: floor + 16, "text-anchor": "middle" }, text);
    }
    if (isLast) svg(this.drawing, "text", { x: (left + width - right) / 2, y: floor + 34, "text-anchor": "middle" }, "time [s]");
    // A drawing within the drawing cuts what lies beyond the frame.
    const frame = { x: left, y: top, width: width - left - right, height };
    const inner = svg(this.drawing, "svg", { ...frame, viewBox: `${left} ${top} ${frame.width} ${height}` });
    if (this.about.command)
      svg(inner, "path", { class: "command", d: `M${left} ${this.y(this.about.command.value)}H${width - right}` });
    lines.forEach((points, i) => svg(inner, "path", { class: `trace c${this.series[i].colour}`, d: this.path(points) }));
    this.shade = svg(inner, "rect", { class: "selection", y: top, height, width: 0 });
    this.cursor = svg(inner, "path", { class: "cursor" });
    this.hover = svg(inner, "path", { class: "hover" });
    this.dots = this.series.map(one => svg(inner, "circle", { class: `dot c${one.colour}`, r: 3.5 }));
    svg(this.drawing, "rect", { class: "frame", ...frame });
    this.span = `${top}V${floor}`;
  }

  // Least and greatest value in view, with room beyond.
  range(lines) {
    const values = lines.flat().filter(point => point).map(point => point[1]);
    if (this.about.command) values.push(this.about.command.value);
    const low = values.reduce((a, b) => Math.min(a, b), Infinity), high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!(high >= low)) return [0, 1];
    const room = Math.max(0.08 * (high - low), 0.005 * Math.max(Math.abs(low), Math.abs(high))) || 1e-3;
    return [low - room, high + room];
  }

  path(points) {
    let path = "", down = false;
    for (const point of points) {
      if (point) path += `${down ? "L" : "M"}${this.x(point[0]).toFixed(1)} ${this.y(point[1]).toFixed(1)}`;
      down = point !== null;
    }
    return path;
  }

  // Moves the cursor, and reads values off at the pointer or else at the cursor.
  mark(time, pointer) {
    const at = pointer ?? time;
    this.cursor.setAttribute("d", `M${this.x(time)} ${this.span}`);
    this.hover.setAttribute("d", pointer === null ? "" : `M${this.x(pointer)} ${this.span}`);
    this.series.forEach((one, i) => {
      const sample = one.nearest(at), bounds = sample === undefined ? [NaN, NaN] : one.bounds(sample);
      const isSeen = Number.isFinite(bounds[1]);
      this.values[i].textContent = isSeen ? `${writtenBounds(bounds)} ${this.about.unit}`.trim() : "–";
      this.dots[i].style.display = isSeen ? "" : "none";
      if (!isSeen) return;
      this.dots[i].setAttribute("cx", this.x(one.time(sample)));
      this.dots[i].setAttribute("cy", this.y(bounds[1]));
    });
  }

  select(times) {
    const [from, to] = times ? times.map(this.x).sort((a, b) => a - b) : [0, 0];
    this.shade.setAttribute("x", from);
    this.shade.setAttribute("width", to - from);
  }
}

// How the lugs met the ground, as a strip over the same axis.
class ClassStrip {
  constructor(parent, spans) {
    this.spans = spans;
    const panel = html(parent, "div", "run-panel"), head = html(panel, "div", "run-head");
    html(head, "span", "run-name", "How the lugs met the ground");
    this.now = html(head, "span", "run-value");
    this.drawing = svg(panel, "svg", { role: "img", "aria-label": "Class over time" });
  }

  draw(view, width) {
    const { left, right } = MARGIN, across = width - left - right;
    this.drawing.replaceChildren();
    this.drawing.setAttribute("viewBox", `0 0 ${width} 26`);
    this.drawing.style.height = "26px";
    const x = time => clamp(left + (time - view[0]) / (view[1] - view[0]) * across, left, left + across);
    for (const { start, end, class: name, terrain, colour } of this.spans) {
      const from = x(start), long = x(end) - from;
      svg(this.drawing, "rect", { x: from, y: 1, width: long, height: 22, fill: colour });
      const text = [`${name} on ${terrain}`, name].find(text => 8 * text.length < long);
      if (text) svg(this.drawing, "text", { class: "on-colour", x: from + long / 2, y: 17, "text-anchor": "middle" }, text);
    }
  }

  mark(time, pointer) {
    const at = pointer ?? time, now = this.spans.find(({ start, end }) => start <= at && at < end);
    this.now.textContent = now ? `${now.class} (${now.meaning}) on ${now.terrain}` : "–";
  }

  select() {}
}
