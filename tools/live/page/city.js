// The city from above: buildings, base stations, the route, the UAV, and the base station that serves it.

import {prepared} from './plot.js';

const slack_m = 150;

/** What is shown: the route of this flight, and the base stations that serve the agent on it. */
function frameOf(flight, track) {
  const {x_m, y_m} = flight.route ?? track;
  const xs = x_m.filter((x) => x !== null);
  const ys = y_m.filter((y) => y !== null);
  if (xs.length === 0) return {x: [-slack_m, slack_m], y: [-slack_m, slack_m]};
  for (const cell of new Set(track.serving_cell)) {
    const station = flight.city?.base_stations[cell];
    if (station) { xs.push(station[0]); ys.push(station[1]); }
  }
  const range = (values) => [Math.min(...values) - slack_m, Math.max(...values) + slack_m];
  return {x: range(xs), y: range(ys)};
}

/** Draws the city with the agent's UAV after step index `at`. */
export function drawCity(canvas, {flight, track, at, surface, colour, dark}) {
  const frame = frameOf(flight, track);
  const breadth = Math.max(200, canvas.clientWidth);
  const scale = Math.min(breadth / (frame.x[1] - frame.x[0]), 460 / (frame.y[1] - frame.y[0]));
  const height = Math.max(180, Math.round(scale * (frame.y[1] - frame.y[0])));
  const {context, width} = prepared(canvas, height);
  const middle = [(frame.x[0] + frame.x[1]) / 2, (frame.y[0] + frame.y[1]) / 2];
  const toX = (x_m) => width / 2 + scale * (x_m - middle[0]);
  const toY = (y_m) => height / 2 - scale * (y_m - middle[1]);
  if (flight.city) drawBuildings(context, flight.city, {toX, toY, scale, width, height, dark});
  drawRoute(context, flight.route ?? track, track, at, {toX, toY, surface, colour});
  const serving = track.serving_cell[at];
  if (flight.city) {
    const station = flight.city.base_stations[serving];
    if (station && track.x_m[at] !== null) drawBeam(context, [toX(station[0]), toY(station[1])], [toX(track.x_m[at]), toY(track.y_m[at])], colour);
    flight.city.base_stations.forEach(([x_m, y_m], cell) => drawStation(context, toX(x_m), toY(y_m), cell === serving ? cell : null, {surface, colour}));
  }
  drawScale(context, scale, height, surface);
}

function drawBuildings(context, city, {toX, toY, scale, width, height, dark}) {
  const side = scale * city.building_width_m;
  const tallest = Math.max(1, ...city.buildings.map((building) => building[2]));
  for (const [x_m, y_m, tall_m] of city.buildings) {
    const left = toX(x_m) - side / 2;
    const top = toY(y_m) - side / 2;
    if (left > width || top > height || left + side < 0 || top + side < 0) continue;
    const share = tall_m / tallest;
    const light = dark ? 14 + 34 * share : 93 - 36 * share;
    context.fillStyle = `hsl(215 14% ${light}%)`;
    context.fillRect(left, top, side, side);
  }
}

/** The whole `route` as far as it is known, and what the UAV has flown of it. */
function drawRoute(context, route, track, at, {toX, toY, surface, colour}) {
  const path = ({x_m, y_m}, to) => {
    context.beginPath();
    for (let i = 0; i <= to; ++i) if (x_m[i] !== null) context.lineTo(toX(x_m[i]), toY(y_m[i]));
    context.stroke();
  };
  context.lineWidth = 2;
  context.strokeStyle = surface.soft;
  context.setLineDash([3, 4]);
  path(route, route.x_m.length - 1);
  context.setLineDash([]);
  context.lineWidth = 3;
  context.strokeStyle = colour;
  path(track, at);
  if (track.x_m[at] === null) return;
  context.fillStyle = colour;
  context.strokeStyle = surface.background;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(toX(track.x_m[at]), toY(track.y_m[at]), 7, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
}

/** A wedge that opens towards the UAV, and a line. */
function drawBeam(context, [x, y], [toX, toY], colour) {
  const direction = Math.atan2(toY - y, toX - x);
  const length = Math.hypot(toX - x, toY - y);
  context.globalAlpha = 0.22;
  context.fillStyle = colour;
  context.beginPath();
  context.moveTo(x, y);
  context.arc(x, y, length, direction - 0.12, direction + 0.12);
  context.closePath();
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(toX, toY);
  context.stroke();
}

function drawStation(context, x, y, serves, {surface, colour}) {
  const size = serves === null ? 5 : 8;
  context.fillStyle = serves === null ? surface.background : colour;
  context.strokeStyle = serves === null ? surface.soft : surface.ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - size);
  context.lineTo(x + size, y + size * 0.8);
  context.lineTo(x - size, y + size * 0.8);
  context.closePath();
  context.fill();
  context.stroke();
  if (serves === null) return;
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  context.lineWidth = 3;
  context.strokeStyle = surface.background;
  context.strokeText(String(serves), x, y - size - 2);
  context.fillStyle = surface.ink;
  context.fillText(String(serves), x, y - size - 2);
}

function drawScale(context, scale, height, surface) {
  const length_m = [50, 100, 200, 500, 1000, 2000, 5000].find((length) => length * scale >= 60) ?? 10000;
  context.strokeStyle = surface.ink;
  context.fillStyle = surface.ink;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(10, height - 10);
  context.lineTo(10 + length_m * scale, height - 10);
  context.stroke();
  context.textAlign = 'left';
  context.textBaseline = 'bottom';
  context.fillText(`${length_m} m`, 10, height - 14);
}
