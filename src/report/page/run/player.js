// A run that is played: one time for the picture, the slider and the cursor in the traces.

class Player {
  constructor(root, about) {
    Object.assign(this, { root, about, time: about.span[0], pointer: null, view: [...about.span] });
  }

  async load() {
    const { about, root } = this;
    const all = texts => Promise.all(texts.map(unpack));
    const panels = await Promise.all(about.panels.map(async panel =>
      ({ panel, series: await Promise.all(panel.series.map(async one => new Series(one, await unpack(one.data)))) })));
    if (about.scene) await this.loadPicture(about.scene, panels.flatMap(({ series }) => series), all);
    this.addControls();
    this.traces = html(root, "div", "run-traces");
    this.traces.tabIndex = 0;
    this.traces.setAttribute("role", "group");
    this.traces.setAttribute("aria-label", "Channels over time; arrow keys move the cursor, plus and minus zoom, 0 shows the whole run");
    this.panels = panels.map(({ panel, series }) => new Trace(this.traces, panel, series));
    if (about.classes.length) {
      this.panels.unshift(new ClassStrip(this.traces, about.classes));
      this.traces.prepend(this.traces.lastChild);
    }
    this.addNotes();
    this.listen();
    new ResizeObserver(() => this.layOut()).observe(root);
    this.layOut();
    root.classList.add("ready");
  }

  async loadPicture(scene, series, all) {
    const [poses, surface, rut, contacts] = await Promise.all([scene.poses, scene.surface, scene.rut, scene.contacts].map(all));
    const { ground: groundKind, ...about } = scene, [x, y, angle] = poses;
    const loads = Object.fromEntries(series.map(one => [one.channel, one]));
    const frame = html(this.root, "div", "run-picture");
    this.picture = new Picture(frame, { ...about, groundKind }, { x, y, angle, surface, rut, contacts }, this.about.classes, loads);
  }

  addControls() {
    const bar = html(this.root, "div", "run-controls"), [from, to] = this.about.span;
    const button = (text, label, act) => {
      const made = html(bar, "button", "", text);
      made.type = "button";
      made.setAttribute("aria-label", label);
      made.addEventListener("click", act);
      return made;
    };
    this.playing = button("▶", "Play", () => this.toggle());
    this.slider = html(bar, "input", "run-slider");
    Object.assign(this.slider, { type: "range", min: from, max: to, step: Math.min(0.01, (to - from) / 100), value: from });
    this.slider.setAttribute("aria-label", "Time in seconds");
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    this.clock = html(bar, "output", "run-clock");
    this.speed = html(bar, "select", "run-speed");
    this.speed.setAttribute("aria-label", "Speed");
    for (const [text, value] of [["× 0.1", 0.1], ["× 0.5", 0.5], ["× 1", 1], ["× 2", 2], ["× 5", 5]])
      this.speed.add(new Option(text, value, value === 1, value === 1));
    button("−", "Zoom out", () => this.zoom(2));
    button("+", "Zoom in", () => this.zoom(0.5));
    button("Whole run", "Show the whole run", () => this.show(this.about.span));
    this.at = html(this.root, "p", "run-at caption");
  }

  addNotes() {
    html(this.root, "p", "caption", "Drag across a trace to zoom into a stretch, double-click for the whole run; pinch, or turn the wheel with Ctrl or "
      + "after a click into the traces. Keys: ← → move the cursor, + − 0 zoom, space plays. Values are the samples nearest to the "
      + "time, to the six digits of single precision; none is interpolated.");
    for (const note of this.about.notes) html(this.root, "p", "run-note", note);
  }

  // Lays picture and traces out for the width there is.
  layOut() {
    const width = Math.round(this.root.clientWidth);
    if (!width || width === this.width) return;
    this.width = width;
    this.picture?.draw(width, Math.round(clamp(0.34 * width, 230, 330)));
    this.show(this.view);
  }

  // Shows a stretch of time.
  show([from, to]) {
    const [first, last] = this.about.span, long = clamp(to - from, (last - first) / 1e5, last - first);
    const start = clamp(from, first, last - long);
    this.view = [start, start + long];
    this.panels.forEach((panel, i) => panel.draw(this.view, this.width, this.width < 600 ? 84 : 100, i === this.panels.length - 1));
    this.mark();
  }

  // Zooms about a time that stays where it is.
  zoom(factor, about = this.time) {
    const [from, to] = this.view, centre = clamp(about, from, to);
    this.show([centre - factor * (centre - from), centre + factor * (to - centre)]);
  }

  go(time) {
    this.time = clamp(time, ...this.about.span);
    const [from, to] = this.view, long = to - from;
    if (this.time < from) this.show([this.time - 0.9 * long, this.time + 0.1 * long]);
    else if (this.time > to) this.show([this.time - 0.1 * long, this.time + 0.9 * long]);
    else this.mark();
  }

  mark() {
    this.slider.value = this.time;
    this.clock.textContent = `${this.time.toFixed(2)} s`;
    this.at.textContent = `Values at ${(this.pointer ?? this.time).toFixed(4)} s`;
    for (const panel of this.panels) panel.mark(this.time, this.pointer);
    this.picture?.show(this.time);
  }

  toggle() {
    this.isPlaying = !this.isPlaying;
    this.playing.textContent = this.isPlaying ? "❚❚" : "▶";
    this.playing.setAttribute("aria-label", this.isPlaying ? "Pause" : "Play");
    if (!this.isPlaying) return;
    if (this.time >= this.about.span[1]) this.go(this.about.span[0]);
    let before = performance.now();
    const frame = now => {
      if (!this.isPlaying) return;
      this.go(this.time + Math.max(0, now - before) / 1e3 * Number(this.speed.value));
      before = now;
      if (this.time >= this.about.span[1]) this.toggle(); else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  // Time under a place across the window.
  timeAt(clientX) {
    const { left } = this.traces.getBoundingClientRect(), across = this.width - MARGIN.left - MARGIN.right;
    const part = clamp((clientX - left - MARGIN.left) / across, 0, 1);
    return this.view[0] + part * (this.view[1] - this.view[0]);
  }

  listen() {
    const { traces } = this, on = (name, act) => traces.addEventListener(name, act, { passive: false });
    this.touches = new Map();
    on("pointerdown", event => this.press(event));
    on("pointermove", event => this.move(event));
    on("pointerup", event => this.release(event));
    on("pointercancel", event => { this.touches.delete(event.pointerId); this.select(null); });
    on("pointerleave", () => { this.pointer = null; this.mark(); });
    on("dblclick", () => this.show(this.about.span));
    on("keydown", event => this.key(event));
    on("wheel", event => {
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== traces) return;
      event.preventDefault();
      this.zoom(2 ** clamp(event.deltaY / 200, -1, 1), this.timeAt(event.clientX));
    });
    addEventListener("beforeprint", () => this.show(this.about.span));
  }

  // A mouse selects a stretch; a finger moves the cursor; two fingers hold the times they were put on.
  press(event) {
    if (event.button > 0) return;
    this.touches.set(event.pointerId, this.timeAt(event.clientX));
    this.pressed = event.clientX;
    if (event.pointerType === "touch") this.pointer = null;
  }

  move(event) {
    const time = this.timeAt(event.clientX), held = this.touches.get(event.pointerId);
    if (event.pointerType !== "touch") {
      this.pointer = time;
      if (held !== undefined) this.select([held, time]);
      this.mark();
    } else if (this.touches.size === 2) this.pinch(event);
    else if (held !== undefined) this.go(time);
  }

  pinch(event) {
    this.places ??= new Map();
    this.places.set(event.pointerId, event.clientX);
    if (this.places.size < 2) return;
    const ids = [...this.touches.keys()], [a, b] = ids.map(id => this.places.get(id)), [from, to] = ids.map(id => this.touches.get(id));
    if (a === undefined || b === undefined || Math.abs(a - b) < 8 || from === to) return;
    const { left } = this.traces.getBoundingClientRect(), edge = left + MARGIN.left, across = this.width - MARGIN.left - MARGIN.right;
    const long = Math.abs((to - from) / (b - a)) * across, start = from - (a - edge) / across * long;
    this.show([start, start + long]);
  }

  release(event) {
    const held = this.touches.get(event.pointerId), time = this.timeAt(event.clientX);
    const isPinch = this.touches.size > 1 || this.places?.size > 1;
    this.touches.delete(event.pointerId);
    if (!this.touches.size) this.places = undefined;
    this.select(null);
    if (held === undefined || isPinch) return;
    if (event.pointerType !== "touch" && Math.abs(event.clientX - this.pressed) > 6) this.show([held, time].sort((a, b) => a - b));
    else this.go(time);
  }

  select(times) { for (const panel of this.panels) panel.select(times); }

  key(event) {
    const step = (this.view[1] - this.view[0]) / (event.shiftKey ? 1000 : 100);
    const acts = {
      ArrowLeft: () => this.go(this.time - step), ArrowRight: () => this.go(this.time + step),
      Home: () => this.go(this.about.span[0]), End: () => this.go(this.about.span[1]),
      "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2),
      0: () => this.show(this.about.span), " ": () => this.toggle(),
    };
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.pointer = null;
    acts[event.key]();
  }
}

for (const root of document.querySelectorAll(".run"))
  new Player(root, JSON.parse(root.querySelector("script").textContent)).load();
