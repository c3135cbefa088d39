// Lines over steps or seconds on a canvas, redrawn as a whole each time: fast enough for 20 agents at 60 frames per second.

const margin = {left: 54, right: 10, top: 8, bottom: 30};
const font = '12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

/** Sizes the canvas to its place on the page, at the resolution of the screen. Returns its context and size in CSS pixels. */
export function prepared(canvas, height) {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(200, canvas.clientWidth);
  canvas.style.height = `${height}px`;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = font;
  return {context, width, height};
}

/** Round values that divide [low, high] into about `count` parts. */
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  if (!(rough > 0) || !Number.isFinite(rough)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const values = [];
  for (let value = Math.ceil(low / step) * step; value <= high + step * 1e-9; value += step) values.push(Math.abs(value) < step * 1e-9 ? 0 : value);
  return values;
}

/** The least and the greatest finite value, a little apart if they are equal; null if there is none. */
export function extent(lists) {
  let low = Infinity;
  let high = -Infinity;
  for (const list of lists) for (const value of list) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  if (low > high) return null;
  const room = high > low ? 0.04 * (high - low) : Math.max(1e-3, 0.1 * Math.abs(low));
  return [low - room, high + room];
}

function label(value, step) {
  const decimals = Math.max(0, Math.min(6, -Math.floor(Math.log10(step || 1) + 1e-9)));
  return Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-4) ? value.toExponential(0) : value.toFixed(decimals).replace('-', '−');
}

/**
 * Draws `lines` [{values, colour, dash, width, steps}] over `x` (one position per value) in the range `xRange`, `yRange`.
 * `under(toX, toY)` draws beneath them, `now` marks a position. `surface`: the colours of the theme.
 */
export function plot(canvas, {height, surface, x, xRange, yRange, xTitle, lines, now, under}) {
  const {context, width} = prepared(canvas, height);
  const inner = {width: width - margin.left - margin.right, height: height - margin.top - margin.bottom};
  const toX = (value) => margin.left + (value - xRange[0]) / (xRange[1] - xRange[0] || 1) * inner.width;
  const toY = (value) => margin.top + (yRange[1] - value) / (yRange[1] - yRange[0] || 1) * inner.height;
  if (under) {
    context.save();
    context.beginPath();
    context.rect(margin.left, margin.top, inner.width, inner.height);
    context.clip();
    under(context, toX, toY);
    context.restore();
  }
  drawAxes(context, {surface, xRange, yRange, toX, toY, inner, xTitle});
  context.save();
  context.beginPath();
  context.rect(margin.left, margin.top, inner.width, inner.height);
  context.clip();
  for (const line of lines) drawLine(context, line, x, toX, toY);
  context.restore();
  if (now === undefined) return;
  context.strokeStyle = surface.ink;
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(toX(now), margin.top);
  context.lineTo(toX(now), margin.top + inner.height);
  context.stroke();
}

function drawAxes(context, {surface, xRange, yRange, toX, toY, inner, xTitle}) {
  context.lineWidth = 1;
  context.fillStyle = surface.soft;
  context.strokeStyle = surface.grid;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  const ys = ticks(...yRange, Math.max(2, inner.height / 45));
  for (const value of ys) {
    context.beginPath();
    context.moveTo(margin.left, toY(value));
    context.lineTo(margin.left + inner.width, toY(value));
    context.stroke();
    context.fillText(label(value, ys[1] - ys[0]), margin.left - 6, toY(value));
  }
  context.textAlign = 'center';
  context.textBaseline = 'top';
  const xs = ticks(...xRange, Math.max(2, inner.width / 90));
  for (const value of xs) context.fillText(label(value, xs[1] - xs[0]), toX(value), margin.top + inner.height + 4);
  context.textAlign = 'right';
  context.fillText(xTitle, margin.left + inner.width, margin.top + inner.height + 17);
}

function drawLine(context, {values, colour, dash, width, steps}, x, toX, toY) {
  context.strokeStyle = colour;
  context.lineWidth = width ?? 1.5;
  context.setLineDash(dash?.length === 2 && dash[1] > 0 ? dash : []);
  context.beginPath();
  let drawing = false;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i];
    if (value === null || !Number.isFinite(value)) { drawing = false; continue; }
    if (drawing && steps) context.lineTo(toX(x[i]), toY(values[i - 1]));
    if (drawing) context.lineTo(toX(x[i]), toY(value)); else context.moveTo(toX(x[i]), toY(value));
    drawing = true;
  }
  context.stroke();
  context.setLineDash([]);
}
