// A number with so many decimals; 0 has no sign.
const fixed = (value, decimals) => value.toFixed(decimals).replace(/^-(0\.?0*)$/, "$1").replace("-", "−");

// Round numbers along an axis, about so many at most, and what to write there.
function ticks([low, high], most) {
  const raw = (high - low) / most, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(times => times * decade).find(step => step >= raw * (1 - 1e-9));
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push([n * step, fixed(n * step, decimals)]);
  return found;
}
