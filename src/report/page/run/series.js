// Numbers of a run: as they come packed in the page, by time, and as text.

// Values in single precision: planes of bytes, a zlib stream, Base64.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer()), count = planes.length / 4;
  const values = new Uint8Array(planes.length);
  for (let plane = 0; plane < 4; plane++)
    for (let i = 0; i < count; i++) values[4 * i + plane] = planes[plane * count + i];
  return new Float32Array(values.buffer);
}

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

// Least and greatest of each four neighbours; NaN where all are.
function quartered([lows, highs]) {
  const count = Math.ceil(lows.length / 4), least = new Float32Array(count).fill(NaN), most = least.slice();
  for (let i = 0; i < lows.length; i++) {
    const at = i >> 2;
    if (!(lows[i] >= least[at])) least[at] = Number.isNaN(lows[i]) ? least[at] : lows[i];
    if (!(highs[i] <= most[at])) most[at] = Number.isNaN(highs[i]) ? most[at] : highs[i];
  }
  return [least, most];
}

// A channel over time, with bounds of 1, 4, 16, ... neighbours so that a wide view costs no more than a narrow one.
class Series {
  constructor(about, data) {
    Object.assign(this, about);
    const half = data.length / 2;
    this.levels = [this.block > 1 ? [data.subarray(0, half), data.subarray(half)] : [data, data]];
    while (this.levels.at(-1)[0].length > 64) this.levels.push(quartered(this.levels.at(-1)));
    this.count = this.levels[0][0].length;
    this.period = this.block / this.rate;
    this.first = this.start + (this.block - 1) / 2 / this.rate;
  }

  time(i) { return this.first + i * this.period; }

  // Place of the sample nearest to a time; undefined before the first and after the last.
  nearest(time) {
    const i = Math.round((time - this.first) / this.period);
    return i >= 0 && i < this.count ? i : undefined;
  }

  // Least and greatest value of a sample, in the panel's unit: the same but for stretches of samples.
  bounds(i) { return this.levels[0].map(values => values[i] * this.factor); }

  // Points of a line over the times of a view: [time, value], or null where it has a gap.
  *points([from, to], columns) {
    const i = clamp(Math.floor((from - this.first) / this.period), 0, this.count);
    const end = clamp(Math.ceil((to - this.first) / this.period) + 1, 0, this.count);
    const each = (end - i) / columns;
    const level = each <= 2 ? 0 : clamp(Math.floor(Math.log2(each) / 2), 0, this.levels.length - 1);
    const size = 4 ** level, [lows, highs] = this.levels[level];
    for (let at = Math.floor(i / size); at < Math.ceil(end / size); at++) {
      if (Number.isNaN(lows[at])) { yield null; continue; }
      const time = this.time(at * size + (size - 1) / 2);
      yield [time, lows[at] * this.factor];
      if (highs[at] !== lows[at]) yield [time, highs[at] * this.factor];
    }
  }
}

// Six digits, as many as single precision has.
const written = value => Number.isFinite(value) ? String(Number(value.toPrecision(6))).replaceAll("-", "−") : "–";
const writtenBounds = ([low, high]) => low === high ? written(low) : `${written(low)} to ${written(high)}`;

// A symbol such as F_{DP} in HTML.
function symbol(text) {
  const [letter, index] = text.replace("}", "").split("_{"), set = document.createElement("i");
  set.textContent = letter;
  return index ? [set, Object.assign(document.createElement("sub"), { textContent: index })] : [set];
}

function html(parent, name, className = "", text = "") {
  const element = document.createElement(name);
  element.className = className;
  element.textContent = text;
  parent.append(element);
  return element;
}

function svg(parent, name, attributes = {}, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  element.textContent = text;
  parent.append(element);
  return element;
}

const line = points => points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
