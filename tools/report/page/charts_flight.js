// Charts of one chosen flight: what every agent did on the same world.

import {agentScales, cellColours, surfaces} from './theme.js';
import {markedLabel, named} from './privilege.js';
import {agentLineEncoding, agentTip, pickInLegend, qosTitle} from './charts_statistics.js';

const moving_mean_steps = 10;

/** One row per agent and step; learners last, so that their lines lie on top. */
function stepRows(data, flight, field) {
  const learns = (name) => data.agents.find((agent) => agent.name === name)?.learns ?? false;
  const agents = [...flight.agents].sort((a, b) => learns(a.name) - learns(b.name));
  return agents.flatMap((agent) => agent[field].map((value, i) => ({...named(data, agent.name), step: flight.step[i], value})));
}

function agentNames(flight) {
  return flight.agents.map((agent) => agent.name);
}

const stepAxis = {title: 'Step', tickCount: 8, grid: false};

export function heightOverSteps(data, condition, context) {
  const {flight} = condition;
  return {
    usermeta: {agents: agentNames(flight)},
    height: 280,
    data: {values: stepRows(data, flight, 'height_m')},
    params: [pickInLegend],
    mark: {type: 'line', strokeWidth: 2, interpolate: 'step-after'},
    encoding: {
      x: {field: 'step', type: 'quantitative', scale: {nice: false}, axis: stepAxis},
      y: {field: 'value', type: 'quantitative', scale: {domain: [flight.height_min_m, flight.height_max_m]}, axis: {title: 'Height (m)'}},
      ...agentLineEncoding(data, context, agentNames(flight)),
      tooltip: [agentTip, {field: 'step', title: 'Step'}, {field: 'value', title: 'Height (m)'}],
    },
  };
}

/** The mean over the last ten steps, because fading makes single steps vary. */
export function qosOverSteps(data, condition, context) {
  const {flight} = condition;
  return {
    usermeta: {agents: agentNames(flight)},
    height: 280,
    data: {values: stepRows(data, flight, 'qos')},
    params: [pickInLegend],
    transform: [{
      window: [{op: 'mean', field: 'value', as: 'smooth'}], frame: [1 - moving_mean_steps, 0], groupby: ['agent'], sort: [{field: 'step'}],
    }],
    mark: {type: 'line', strokeWidth: 2},
    encoding: {
      x: {field: 'step', type: 'quantitative', scale: {nice: false}, axis: stepAxis},
      y: {field: 'smooth', type: 'quantitative', scale: {zero: false}, axis: {title: qosTitle(condition)}},
      ...agentLineEncoding(data, context, agentNames(flight)),
      tooltip: [
        agentTip, {field: 'step', title: 'Step'},
        {field: 'value', title: 'At this step', format: '.2f'}, {field: 'smooth', title: 'Mean of the last 10', format: '.2f'},
      ],
    },
  };
}

/** QoS over route point and height, with the heights the agents flew. */
export function heatMap(data, condition, context) {
  const {flight} = condition;
  const {map} = flight;
  const rise = map.height_m.length > 1 ? map.height_m[1] - map.height_m[0] : 1;
  // Cells overlap their neighbours a little, so that no seams show at any zoom.
  const cells = map.qos.flatMap((column, i) => column.map((qos, k) => ({
    step: flight.step[i], height: map.height_m[k], qos,
    left: flight.step[i] - 0.5, right: flight.step[i] + 0.54, low: map.height_m[k] - rise / 2, high: map.height_m[k] + 0.54 * rise,
  })));
  const shown = (name) => name === context.agent || ['one-step-ahead', 'planner'].includes(name);
  const flown = stepRows(data, flight, 'height_m').filter((row) => shown(row.agent));
  const names = agentNames(flight).filter(shown);
  const scales = agentScales(data, 'dark', names);
  const last = flight.step.length - 1;
  const x = {type: 'quantitative', scale: {domain: [flight.step[0] - 0.5, flight.step[last] + 0.5], nice: false}, axis: stepAxis};
  const y = {
    type: 'quantitative', axis: {title: 'Height (m)', grid: false},
    scale: {domain: [flight.height_min_m - rise / 2, flight.height_max_m + rise / 2], nice: false},
  };
  const line = (width, encoding) => ({
    data: {values: flown}, mark: {type: 'line', strokeWidth: width, interpolate: 'step-after', clip: true},
    encoding: {x: {...x, field: 'step'}, y: {...y, field: 'value'}, ...encoding},
  });
  return {
    usermeta: {agents: names},
    height: 320,
    layer: [
      {
        data: {values: cells}, mark: {type: 'rect', clip: true},
        encoding: {
          x: {...x, field: 'left'}, x2: {field: 'right'}, y: {...y, field: 'low'}, y2: {field: 'high'},
          color: {field: 'qos', type: 'quantitative', scale: {scheme: 'greys', reverse: true}, legend: {title: qosTitle(condition), orient: 'bottom', gradientLength: Math.min(260, context.width - 80)}},
          tooltip: [{field: 'step', title: 'Step'}, {field: 'height', title: 'Height (m)'}, {field: 'qos', title: qosTitle(condition), format: '.2f'}],
        },
      },
      line(4.5, {detail: {field: 'agent'}, color: {value: '#000000'}, opacity: {value: 0.75}}),
      line(2.2, {stroke: {field: 'agent', type: 'nominal', scale: scales.colour, legend: {orient: 'top', title: null, labelExpr: markedLabel(data), symbolType: 'stroke', symbolStrokeWidth: 3, symbolSize: 200}}}),
    ],
    resolve: {scale: {color: 'independent', stroke: 'independent'}},
  };
}

/** The part of the city that the flight and its serving base stations span, m. */
function cityFrame(flight, track, cells) {
  const points = [...track.x_m.map((x, i) => [x, track.y_m[i]]), ...cells.map((cell) => [cell.x_m, cell.y_m])];
  const xs = points.map((point) => point[0]);
  const ys = points.map((point) => point[1]);
  const margin = 130;
  return {x: [Math.min(...xs) - margin, Math.max(...xs) + margin], y: [Math.min(...ys) - margin, Math.max(...ys) + margin]};
}

/** The city from above: buildings, base stations, the route, and which base station served the agent where. */
export function cityMap(data, condition, context) {
  const {flight} = condition;
  const {city} = flight;
  const surface = surfaces[context.theme];
  const track = flight.agents.find((agent) => agent.name === context.agent) ?? flight.agents[0];
  const ids = [...new Set(track.serving_cell)].filter((id) => id >= 0);
  const stations = city.base_stations.map(([x_m, y_m], id) => ({id, x_m, y_m}));
  const serving = ids.map((id) => stations[id]);
  const frame = cityFrame(flight, track, serving);
  const inside = (x, y, slack) => x > frame.x[0] - slack && x < frame.x[1] + slack && y > frame.y[0] - slack && y < frame.y[1] + slack;
  const half = city.building_width_m / 2;
  const buildings = city.buildings.filter(([x, y]) => inside(x, y, -half)).map(([x, y, height]) => ({left: x - half, right: x + half, low: y - half, high: y + half, height}));
  const steps = track.x_m.map((x_m, i) => ({
    step: flight.step[i], x_m, y_m: track.y_m[i], cell: String(track.serving_cell[i]),
    cell_x_m: stations[track.serving_cell[i]]?.x_m, cell_y_m: stations[track.serving_cell[i]]?.y_m,
  })).filter((row) => row.cell_x_m !== undefined);
  const palette = cellColours[context.theme];
  const cellColour = {
    field: 'cell', type: 'nominal', scale: {domain: ids.map(String), range: ids.map((_, i) => palette[i % palette.length])},
    legend: {title: 'Serving base station', orient: 'bottom', columns: Math.max(4, Math.floor(context.width / 60)), symbolType: 'circle'},
  };
  const axis = (title) => ({title, grid: false, tickCount: 6});
  const x = {type: 'quantitative', scale: {domain: frame.x, nice: false}, axis: axis('x (m)')};
  const y = {type: 'quantitative', scale: {domain: frame.y, nice: false}, axis: axis('y (m)')};
  const at = {x: {...x, field: 'x_m'}, y: {...y, field: 'y_m'}};
  const stationTip = [{field: 'id', title: 'Base station'}, {field: 'x_m', title: 'x (m)', format: '.0f'}, {field: 'y_m', title: 'y (m)', format: '.0f'}];
  const plotWidth = context.width - 60;
  const per_px = (frame.x[1] - frame.x[0]) / plotWidth;
  const labelled = [];  // a base station that stands where the number of another one is written has its own in the tooltip
  for (const station of serving)
    if (labelled.every((other) => Math.abs(other.x_m - station.x_m) > 30 * per_px || Math.abs(other.y_m - station.y_m) > 16 * per_px)) labelled.push(station);
  const others = stations.filter((station) => !ids.includes(station.id) && inside(station.x_m, station.y_m, 0));
  return {
    usermeta: {agents: [track.name]},
    height: Math.round(plotWidth * (frame.y[1] - frame.y[0]) / (frame.x[1] - frame.x[0])),
    layer: [
      {
        data: {values: buildings}, mark: {type: 'rect', clip: true},
        encoding: {
          x: {...x, field: 'left'}, x2: {field: 'right'}, y: {...y, field: 'low'}, y2: {field: 'high'},
          color: {
            field: 'height', type: 'quantitative', scale: {range: context.theme === 'dark' ? ['#222a35', '#7c8aa0'] : ['#f0f2f5', '#8b97a8']},
            legend: {title: 'Building height (m)', orient: 'top', gradientLength: Math.min(200, context.width - 80)},
          },
          tooltip: [{field: 'height', title: 'Building height (m)'}],
        },
      },
      {
        data: {values: steps}, mark: {type: 'rule', strokeWidth: 1, opacity: 0.45, clip: true},
        encoding: {x: {...x, field: 'x_m'}, y: {...y, field: 'y_m'}, x2: {field: 'cell_x_m'}, y2: {field: 'cell_y_m'}, stroke: {...cellColour, legend: null}},
      },
      {data: {values: others}, mark: {type: 'point', shape: 'triangle-up', size: 70, strokeWidth: 1.4, color: surface.soft, opacity: 1}, encoding: {...at, tooltip: stationTip}},
      {
        data: {values: steps}, mark: {type: 'point', filled: true, size: 26, opacity: 1},
        encoding: {...at, fill: cellColour, tooltip: [{field: 'step', title: 'Step'}, {field: 'cell', title: 'Serving base station'}]},
      },
      {
        data: {values: serving.map((station) => ({...station, cell: String(station.id)}))},
        mark: {type: 'point', shape: 'triangle-up', size: 190, filled: true, opacity: 1, stroke: surface.background, strokeWidth: 1},
        encoding: {...at, fill: cellColour, tooltip: stationTip},
      },
      {
        data: {values: labelled}, mark: {type: 'text', dy: -15, fontSize: 12, fontWeight: 600, color: surface.ink, stroke: surface.background, strokeWidth: 3},
        encoding: {...at, text: {field: 'id'}},
      },
      {
        data: {values: labelled}, mark: {type: 'text', dy: -15, fontSize: 12, fontWeight: 600, color: surface.ink}, encoding: {...at, text: {field: 'id'}},
      },
    ],
    resolve: {scale: {color: 'independent', stroke: 'independent', fill: 'shared'}},
  };
}

function learningRows(condition, context) {
  const track = condition.flight.agents.find((agent) => agent.name === context.learner);
  return {steps: condition.flight.step, learning: track.learning};
}

function singleCurve(data, condition, context, field, title, scale) {
  const {steps, learning} = learningRows(condition, context);
  const [colour] = agentScales(data, context.theme, [context.learner]).colour.range;
  return {
    usermeta: {agents: [context.learner]},
    height: 160,
    data: {values: learning[field].map((value, i) => ({step: steps[i], value})).filter((row) => row.value !== null && (scale.type !== 'log' || row.value > 0))},
    mark: {type: 'line', strokeWidth: 2, color: colour},
    encoding: {
      x: {field: 'step', type: 'quantitative', scale: {nice: false}, axis: stepAxis},
      y: {field: 'value', type: 'quantitative', scale, axis: {title, tickCount: 5, ...(scale.type === 'log' ? {format: '.0e'} : {})}},
      tooltip: [{field: 'step', title: 'Step'}, {field: 'value', title, format: '.4g'}],
    },
  };
}

export function epsilonCurve(data, condition, context) {
  return singleCurve(data, condition, context, 'epsilon', 'Exploration rate ε', {domain: [0, 1]});
}

export function lossCurve(data, condition, context) {
  return singleCurve(data, condition, context, 'loss', 'Training loss', {type: 'log'});
}

/** The network's value of each action at each step. */
export function qValueCurves(data, condition, context) {
  const {steps, learning} = learningRows(condition, context);
  const actions = ['down', 'hold', 'up'];
  const dark = context.theme === 'dark';
  return {
    usermeta: {agents: [context.learner]},
    height: 200,
    data: {values: actions.flatMap((action) => learning[`q_${action}`].map((value, i) => ({action, step: steps[i], value})))},
    mark: {type: 'line', strokeWidth: 1.8},
    encoding: {
      x: {field: 'step', type: 'quantitative', scale: {nice: false}, axis: stepAxis},
      y: {field: 'value', type: 'quantitative', axis: {title: 'Q-value', tickCount: 5}},
      color: {
        field: 'action', type: 'nominal', legend: {orient: 'bottom', title: null, symbolStrokeWidth: 2.5, symbolSize: 260},
        scale: {domain: actions, range: dark ? ['#6f9fe8', '#c0c0c0', '#ff8a3d'] : ['#0058a3', '#777777', '#d5500a']},
      },
      strokeDash: {field: 'action', type: 'nominal', scale: {domain: actions, range: [[5, 2], [2, 2], [1, 0]]}},
      tooltip: [{field: 'action', title: 'Action'}, {field: 'step', title: 'Step'}, {field: 'value', title: 'Q-value', format: '.3g'}],
    },
  };
}
