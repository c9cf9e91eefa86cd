// The wheel on its ground, to scale, with the loads on it.

// Height of a polyline at x; undefined beyond its ends.
function heightAt([xs, ys], x) {
  if (!(x >= xs[0] && x <= xs[xs.length - 1])) return undefined;
  let low = 0, high = xs.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= x) low = middle; else high = middle;
  }
  const part = xs[high] > xs[low] ? (x - xs[low]) / (xs[high] - xs[low]) : 0;
  return ys[low] + part * (ys[high] - ys[low]);
}

class Picture {
  constructor(parent, about, arrays, classes, loads) {
    Object.assign(this, about, arrays);
    this.classes = classes;
    this.loads = loads;
    this.tip = this.radius + this.lug_height;
    const median = values => [...values].sort((a, b) => a - b)[values.length >> 1];
    this.level = median(this.y);
    this.groundLevel = median(this.surface[1]);
    this.heading = Math.sign(this.x[this.x.length - 1] - this.x[0]) || 1;
    this.drawing = svg(parent, "svg", { role: "img", "aria-label": "Wheel and ground" });
  }

  // Lays the drawing out anew.
  draw(width, height) {
    this.width = width;
    this.height = height;
    this.scale = height / (2.6 * this.tip);
    this.drawing.replaceChildren();
    this.drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.drawing.style.height = `${height}px`;
    this.beyond = svg(this.drawing, "path", { class: "soil" });
    this.soil = svg(this.drawing, "path", { class: "soil" });
    this.surfaceLine = svg(this.drawing, "path", { class: "surface" });
    this.before = svg(this.drawing, "path", { class: "before" });
    this.ruler = svg(this.drawing, "g", { class: "ruler" });
    this.wheel = svg(this.drawing, "g");
    this.drawWheel();
    this.arrows = svg(this.drawing, "g");
    this.drawKey();
  }

  drawWheel() {
    const { scale, wheel } = this, rim = this.radius * scale, root = 0.97 * rim, tip = this.tip * scale;
    const wide = Math.max(this.lug_thickness * scale, 1.5);
    this.lugs = Array.from({ length: this.lug_count }, (_, lug) => svg(wheel, "rect", {
      class: "lug", x: -wide / 2, y: root, width: wide, height: tip - root, transform: `rotate(${-360 * lug / this.lug_count})`,
    }));
    svg(wheel, "circle", { class: "rim", r: rim });
    svg(wheel, "circle", { class: "disc", r: 0.9 * rim });
    for (let spoke = 5; spoke >= 0; spoke--)
      svg(wheel, "path", { class: spoke ? "spoke" : "spoke first", d: `M0 ${0.12 * rim}V${0.9 * rim}`, transform: `rotate(${-60 * spoke})` });
    svg(wheel, "circle", { class: "hub", r: 0.12 * rim });
  }

  // Scale and meaning of the dashed line.
  drawKey() {
    const length = [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].find(length => length <= this.radius) ?? 0.01;
    const bar = length * this.scale;
    svg(this.drawing, "path", { class: "bar", d: `M12 26v8m0 -4h${bar}m0 -4v8` });
    svg(this.drawing, "text", { x: 12, y: 18 }, `${Math.round(1e3 * length)} mm`);
    this.key = svg(this.drawing, "g");
    svg(this.key, "path", { class: "before", d: `M${this.width - 40} 14h28` });
    svg(this.key, "text", { x: this.width - 46, y: 18, "text-anchor": "end" }, "surface before");
  }

  // The pose at a time, between two frames.
  pose(time) {
    const place = clamp((time - this.start) / this.step, 0, this.x.length - 1), frame = Math.floor(place), part = place - frame;
    const at = values => values[frame] + part * ((values[frame + 1] ?? values[frame]) - values[frame]);
    return { x: at(this.x), y: at(this.y), angle: at(this.angle) };
  }

  ground(time) { return this.classes.find(({ start, end }) => start <= time && time < end)?.ground ?? this.groundKind; }

  show(time) {
    const pose = this.pose(time), kind = this.ground(time), up = 0.4 * this.tip;
    this.eye = { x: pose.x, y: clamp(this.level, pose.y - up, pose.y + up) };
    this.showGround(pose, kind);
    this.showRuler();
    const [x, y] = this.at(pose.x, pose.y);
    this.wheel.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)}) rotate(${(pose.angle * 180 / Math.PI).toFixed(3)})`);
    this.showContacts(time);
    this.showLoads(time, [x, y]);
  }

  at(x, y) {
    return [this.width / 2 + (x - this.eye.x) * this.scale, this.height * 0.46 - (y - this.eye.y) * this.scale];
  }

  // The ground as it is: undisturbed, but for the rut behind and for what the rim has pressed down; pale and level beyond
  // what is known of it.
  showGround(pose, kind) {
    const now = [], before = [], isSoft = kind === "soil";
    for (let pixel = -2; pixel <= this.width + 2; pixel += 2) {
      const x = this.eye.x + (pixel - this.width / 2) / this.scale, undisturbed = heightAt(this.surface, x);
      if (undisturbed === undefined) continue;
      let height = undisturbed;
      if (isSoft) {
        const below = this.radius ** 2 - (x - pose.x) ** 2;
        if (below > 0) height = Math.min(height, pose.y - Math.sqrt(below));
        if (this.heading * (pose.x - x) >= 0) height = Math.min(height, heightAt(this.rut, x) ?? Infinity);
        before.push(this.at(x, undisturbed));
      }
      now.push(this.at(x, height));
    }
    const path = line(now), floor = this.height + 2;
    const [left, right] = [now[0], now[now.length - 1]], [, level] = this.at(0, this.groundLevel);
    this.beyond.setAttribute("class", `soil beyond ${kind}`);
    this.beyond.setAttribute("d", path && `M-2 ${floor}V${level}H${left[0]}V${floor}ZM${this.width + 2} ${floor}V${level}H${right[0]}V${floor}Z`);
    this.soil.setAttribute("class", `soil ${kind}`);
    this.soil.setAttribute("d", path && `${path}V${floor}H${now[0][0].toFixed(1)}Z`);
    this.surfaceLine.setAttribute("class", `surface ${kind}`);
    this.surfaceLine.setAttribute("d", path);
    this.before.setAttribute("d", line(before));
    this.key.style.display = isSoft ? "" : "none";
  }

  // Positions along the track.
  showRuler() {
    const half = this.width / 2 / this.scale, bottom = this.height;
    this.ruler.replaceChildren();
    for (const [x, text] of ticks([1e3 * (this.eye.x - half), 1e3 * (this.eye.x + half)], Math.max(this.width / 90, 1))) {
      const [pixel] = this.at(1e-3 * x, 0);
      svg(this.ruler, "path", { d: `M${pixel} ${bottom}v-6` });
      if (pixel > 30 && pixel < this.width - 40) svg(this.ruler, "text", { x: pixel, y: bottom - 9, "text-anchor": "middle" }, `${text} mm`);
    }
  }

  showContacts(time) {
    const states = new Map(), [lugs, starts, ends, entered] = this.contacts;
    for (let i = 0; i < lugs.length; i++)
      if (starts[i] <= time && time <= ends[i]) states.set(lugs[i], entered[i] ? "lug entered" : "lug touching");
    this.lugs.forEach((lug, i) => lug.setAttribute("class", states.get(i) ?? "lug"));
  }

  // Arrows of the ground's loads on the wheel: upward at the bottom, forward at the axle, about the axle.
  showLoads(time, [x, y]) {
    const rim = this.radius * this.scale, length = (value, full) => clamp(value / full, -1.2, 1.2);
    this.arrows.replaceChildren();
    const value = name => {
      const load = this.loads[name], sample = load?.nearest(time);
      return sample === undefined ? NaN : load.bounds(sample)[1];
    };
    const normal = 0.75 * rim * length(value("normal_force"), this.force);
    if (normal) this.arrow("c0", [[x, y + this.tip * this.scale], [x, y + this.tip * this.scale - normal]], "N", [12, 4]);
    const pull = 1.25 * rim * length(value("drawbar_pull"), this.force);
    if (pull) this.arrow("c1", [[x, y], [x + pull, y]], "DP", [pull > 0 ? 8 : -34, -8]);
    this.turn(length(value("driving_torque"), this.torque), [x, y], 0.55 * rim);
  }

  arrow(colour, [from, to], index, [aside, down]) {
    if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 2) return;
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
    svg(this.arrows, "path", { class: `arrow ${colour}`, d: line([from, to]) + this.head(to, angle) });
    this.label("F", index, { class: `label ${colour}`, x: to[0] + aside, y: to[1] + down });
  }

  label(letter, index, attributes) {
    const label = svg(this.arrows, "text", attributes);
    svg(label, "tspan", { "font-style": "italic" }, letter);
    svg(label, "tspan", { dy: 3, "font-size": "75%" }, index);
  }

  head([x, y], angle) {
    const wing = turn => [x - 9 * Math.cos(angle + turn), y - 9 * Math.sin(angle + turn)];
    return line([wing(0.45), [x, y], wing(-0.45)]);
  }

  // The torque as an arc from the top, clockwise where it drives forward.
  turn(part, [x, y], radius) {
    const sweep = part * 1.2 * Math.PI;
    if (!(Math.abs(sweep) > 0.05)) return;
    const at = angle => [x + radius * Math.sin(angle), y - radius * Math.cos(angle)], end = at(sweep);
    const arc = `A${radius} ${radius} 0 ${Math.abs(sweep) > Math.PI ? 1 : 0} ${sweep > 0 ? 1 : 0} ${end.map(it => it.toFixed(1)).join(" ")}`;
    svg(this.arrows, "path", { class: "arrow c2", d: line([at(0)]) + arc + this.head(end, sweep + (sweep > 0 ? -0.12 : Math.PI + 0.12)) });
    this.label("T", "D", { class: "label c2", x: at(0)[0] - 6, y: at(0)[1] - 6, "text-anchor": "end" });
  }
}
