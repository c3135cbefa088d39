// Charts over all trials of a condition. Each function returns a Vega-Lite specification without size and theme.

import {agentScales, surfaces} from './theme.js';
import {signedInterval, interval} from './format.js';
import {byKnowledge, isPrivileged, marked, markedLabel, named, shapeOf, tierFill, tierFills} from './privilege.js';

export function qosTitle(condition) {
  return `${condition.qos_name} (${condition.qos_unit})`;
}

/** Legend under the chart; a click shows one agent alone, shift-click adds another. */
function agentLegend(data, context) {
  return {orient: 'bottom', title: null, labelExpr: markedLabel(data), columns: Math.max(1, Math.floor(context.width / 190)), symbolType: 'stroke', symbolStrokeWidth: 2.5, symbolSize: 260};
}

/** The most room for the label of a row, px: enough for most names, and not much more than a third of a narrow chart. */
function labelLimit(context) {
  return Math.min(240, Math.round(0.38 * context.width));
}

/** Colour and dash of an agent's line, dimmed unless picked in the legend. */
export function agentLineEncoding(data, context, names) {
  const scales = agentScales(data, context.theme, names);
  return {
    color: {field: 'agent', type: 'nominal', scale: scales.colour, legend: agentLegend(data, context)},
    strokeDash: {field: 'agent', type: 'nominal', scale: scales.dash, legend: agentLegend(data, context)},
    opacity: {condition: {param: 'picked', value: 1}, value: 0.08},
  };
}

/** The agent of a row as tooltips show it; rows have it from named(). */
export const agentTip = {field: 'shown', title: 'Agent'};

export const pickInLegend = {name: 'picked', select: {type: 'point', fields: ['agent']}, bind: 'legend'};

function agentAxis(data, context, names) {
  const sort = data.agents.map((agent) => agent.name).filter((name) => names.includes(name));
  return {field: 'agent', type: 'nominal', sort, scale: {domain: sort}, axis: {title: null, ticks: false, domain: false, grid: false, labelExpr: markedLabel(data), labelLimit: labelLimit(context)}};
}

/** A layer of the rows for which `has` holds; none if there are no such rows, because Vega warns of empty layers. */
function layerOf(rows, has, layer) {
  const some = rows.filter(has);
  return some.length > 0 ? [{data: {values: some}, ...layer}] : [];
}

/** A row has no bar if there is no interval: with one trial, or where all trials are equal. */
const intervalKnown = (row) => row.low !== null;

function ends(pair) {
  return {low: pair?.[0] ?? null, high: pair?.[1] ?? null};
}

/** The largest value any box plot of this unit reaches, so that the conditions of one report can be compared by eye. */
function sharedMaximum(data, condition, view) {
  let maximum = 0;
  for (const other of data.conditions) {
    if (other.qos_unit !== condition.qos_unit) continue;
    for (const agent of other.views[view]?.agents ?? [])
      maximum = Math.max(maximum, agent.whiskers[1], ...agent.outliers);
  }
  return maximum;
}

/** Per-trial mean QoS: box (quartiles, median), whiskers to the last value within 1.5 box lengths, outliers, mean. */
export function boxPlot(data, condition, context) {
  const agents = condition.views[context.view].agents;
  const names = agents.map((agent) => agent.name);
  const surface = surfaces[context.theme];
  const rows = agents.map((agent) => ({
    ...named(data, agent.name), low: agent.whiskers[0], q25: agent.q25, median: agent.median, q75: agent.q75, high: agent.whiskers[1],
    mean: agent.mean, ci: interval(agent.ci95), trials: agent.trials, hollow: shapeOf(data, agent.name) === 'hollow',
  }));
  const several = (row) => row.trials > 1;  // one value has no quartiles
  const outliers = agents.flatMap((agent) => agent.outliers.map((qos) => ({...named(data, agent.name), qos})));
  const colour = {field: 'agent', type: 'nominal', scale: agentScales(data, context.theme, names).colour, legend: null};
  const y = agentAxis(data, context, names);
  const scale = {domain: [0, sharedMaximum(data, condition, context.view)], nice: true};
  const x = (field) => ({field, type: 'quantitative', scale, axis: {title: qosTitle(condition), tickCount: 6}});
  const tooltip = [
    agentTip, {field: 'trials', title: 'Trials'},
    {field: 'mean', title: 'Mean', format: '.2f'}, {field: 'ci', title: '95 % interval of the mean'},
    {field: 'median', title: 'Median', format: '.2f'},
    {field: 'q25', title: 'Lower quartile', format: '.2f'}, {field: 'q75', title: 'Upper quartile', format: '.2f'},
  ];
  return {
    usermeta: {agents: names},
    height: 26 * rows.length,
    data: {values: rows},
    layer: [
      ...layerOf(rows, several, {mark: {type: 'rule', strokeWidth: 1.4}, encoding: {y, x: x('low'), x2: {field: 'high'}, color: colour, tooltip}}),
      ...layerOf(rows, several, {mark: {type: 'bar', height: 15, strokeWidth: 1.4}, encoding: {y, x: x('q25'), x2: {field: 'q75'}, fill: tierFill(data, colour, surface), fillOpacity: {condition: {test: 'datum.hollow', value: 1}, value: 0.55}, stroke: colour, tooltip}}),
      ...layerOf(rows, several, {mark: {type: 'tick', thickness: 2.4, size: 15, color: surface.ink}, encoding: {y, x: x('median'), tooltip}}),
      {mark: {type: 'point', shape: 'diamond', size: 42, filled: true, color: surface.background, stroke: surface.ink, strokeWidth: 1.2, opacity: 1}, encoding: {y, x: x('mean'), tooltip}},
      ...layerOf(outliers, () => true, {mark: {type: 'point', size: 14, filled: true, opacity: 0.6}, encoding: {y, x: x('qos'), color: colour}}),
    ],
  };
}

/** Paired gain over minimum height on the same worlds, with its 95 % interval. */
export function gainChart(data, condition, context) {
  const agents = condition.views[context.view].agents.filter((agent) => agent.gain && agent.name !== 'min-height');
  const names = agents.map((agent) => agent.name);
  const rows = agents.map((agent) => ({
    ...named(data, agent.name), gain: agent.gain.mean, ...ends(agent.gain.ci95), text: signedInterval(agent.gain.ci95),
    better: agent.gain.probability_of_improvement, pairs: agent.gain.pairs,
  }));
  const colour = {field: 'agent', type: 'nominal', scale: agentScales(data, context.theme, names).colour, legend: null};
  const x = (field) => ({field, type: 'quantitative', axis: {title: `Gain over min-height (${condition.qos_unit})`, tickCount: 6}});
  const y = agentAxis(data, context, names);
  const tooltip = [
    agentTip, {field: 'pairs', title: 'Pairs of flights'}, {field: 'gain', title: 'Mean gain', format: '+.2f'},
    {field: 'text', title: '95 % interval'}, {field: 'better', title: 'Probability of improvement', format: '.0%'},
  ];
  return {
    usermeta: {agents: names},
    height: 24 * rows.length,
    data: {values: rows},
    layer: [
      {data: {values: [{zero: 0}]}, mark: {type: 'rule', strokeDash: [4, 3], color: surfaces[context.theme].soft}, encoding: {x: {field: 'zero', type: 'quantitative'}}},
      ...layerOf(rows, intervalKnown, {mark: {type: 'rule', strokeWidth: 3}, encoding: {y, x: x('low'), x2: {field: 'high'}, color: colour, tooltip}}),
      {mark: {type: 'point', size: 60, strokeWidth: 2, opacity: 1}, encoding: {y, x: x('gain'), color: colour, fill: tierFill(data, colour, surfaces[context.theme]), tooltip}},
    ],
  };
}

/** How often each agent flew at each height: a histogram per agent, in rows of the same height. */
export function heightHistogram(data, condition, context) {
  const agents = condition.views[context.view].agents;
  const names = agents.map((agent) => agent.name);
  const heights = [...new Set(agents.flatMap((agent) => agent.heights.height_m))].sort((a, b) => a - b);
  const width = Math.min(...heights.slice(1).map((height, i) => height - heights[i]), heights.at(-1) - heights[0] || 10);
  const tallest = 0.8;  // of a row
  const rows = agents.flatMap((agent, row) => agent.heights.height_m.map((height, i) => {
    const share = agent.heights.share[i];
    const top = row + 1 - tallest * share / Math.max(...agent.heights.share);
    return {...named(data, agent.name), height, from: height - width / 2, to: height + width / 2, bottom: row + 1, top, share};
  }));
  const surface = surfaces[context.theme];
  const colour = {field: 'agent', type: 'nominal', scale: agentScales(data, context.theme, names).colour, legend: null};
  const y = {type: 'quantitative', scale: {domain: [0, names.length], reverse: true, nice: false}};
  const labels = JSON.stringify(names.map((name) => marked(data, name)));
  return {
    usermeta: {agents: names},
    height: 32 * names.length,
    data: {values: rows},
    mark: {type: 'rect', strokeWidth: 1},
    encoding: {
      x: {field: 'from', type: 'quantitative', scale: {zero: false, nice: false, domain: [heights[0] - width / 2, heights.at(-1) + width / 2]}, axis: {title: 'Height (m)', tickCount: 8, grid: false}},
      x2: {field: 'to'},
      y: {...y, field: 'bottom', axis: {title: null, ticks: false, domain: false, values: names.map((_, row) => row + 1), labelExpr: `${labels}[datum.value - 1]`, labelBaseline: 'bottom', labelLimit: labelLimit(context)}},
      y2: {field: 'top'},
      fill: tierFill(data, colour, surface),
      stroke: colour,
      tooltip: [agentTip, {field: 'height', title: 'Height (m)', format: '.1f'}, {field: 'share', title: 'Share of the steps', format: '.1%'}],
    },
  };
}

/** Share of trials whose mean QoS exceeds a threshold. */
export function performanceProfile(data, condition, context) {
  const view = condition.views[context.view];
  const values = view.agents.flatMap((agent) =>
    agent.profile.map((share, i) => ({...named(data, agent.name), qos: view.profile_thresholds[i], share})));
  return {
    usermeta: {agents: view.agents.map((agent) => agent.name)},
    height: 220,
    data: {values},
    params: [pickInLegend],
    mark: {type: 'line', strokeWidth: 2},
    encoding: {
      x: {field: 'qos', type: 'quantitative', scale: {zero: false, nice: false}, axis: {title: `Threshold of the mean (${condition.qos_unit})`, tickCount: 6}},
      y: {field: 'share', type: 'quantitative', scale: {domain: [0, 1]}, axis: {title: 'Trials above the threshold', format: '.0%', tickCount: 5}},
      ...agentLineEncoding(data, context, view.agents.map((agent) => agent.name)),
      tooltip: [agentTip, {field: 'qos', title: 'Threshold', format: '.2f'}, {field: 'share', title: 'Trials above', format: '.0%'}],
    },
  };
}

/** The gain of an agent over min-height; nothing for min-height itself. */
export function gainOf(agent) {
  return agent.gain && agent.name !== 'min-height' ? {value: agent.gain.mean, ci95: agent.gain.ci95} : {};
}

/** A line with points and intervals per agent. `rows`: named() with {along, order, value, ci95}; `along`, `value`: [channel, encoding]. */
export function linesWithIntervals(data, context, rows, {height, along: [one, along], value: [other, value], tooltip}) {
  const names = [...new Set(rows.map((row) => row.agent))];
  const values = rows.map((row) => ({...row, ...ends(row.ci95), text: interval(row.ci95)}));
  const encoding = agentLineEncoding(data, context, names);
  const fills = tierFills(data, encoding.color.scale, surfaces[context.theme], names);
  const at = {[one]: along, [other]: {...value, field: 'value'}};
  return {
    usermeta: {agents: names},
    height,
    data: {values},
    layer: [
      {params: [pickInLegend], mark: {type: 'line', strokeWidth: 2}, encoding: {...at, order: {field: 'order'}, ...encoding}},
      ...layerOf(values, intervalKnown, {mark: {type: 'rule', strokeWidth: 1.6}, encoding: {[one]: along, [other]: {...value, field: 'low'}, [`${other}2`]: {field: 'high'}, color: encoding.color, opacity: encoding.opacity}}),
      // The fill is no encoding here: its legend would be at odds with that of the lines.
      ...names.map((name, i) => ({
        data: {values: values.filter((row) => row.agent === name)}, mark: {type: 'point', filled: false, fill: fills[i], size: 52, strokeWidth: 2},
        encoding: {...at, color: encoding.color, opacity: encoding.opacity, tooltip: [agentTip, ...tooltip, {field: 'text', title: '95 % interval'}]},
      })),
    ],
  };
}

/** Mean flying height in every condition of one experiment, with 95 % intervals; conditions are rows, which have room for any number of them. */
export function meanHeightChart(data, experiment, context) {
  const conditions = data.conditions.filter((condition) => condition.experiment === experiment && condition.views[context.view]);
  const rows = conditions.flatMap((condition, order) => condition.views[context.view].agents.map((agent) => ({
    ...named(data, agent.name), along: condition.label, order, value: agent.metrics['mean height'], ci95: agent.height_ci95_m,
  })));
  const labels = conditions.map((condition) => condition.label);
  const lines = Math.max(...labels.map((label) => label.split(', ').length));
  return linesWithIntervals(data, context, rows, {
    height: 52 * conditions.length,
    along: ['y', {
      field: 'along', type: 'nominal', sort: labels, scale: {type: 'point', padding: 0.5},
      axis: {title: null, grid: true, labelLimit: labelLimit(context), labelExpr: "split(datum.label, ', ')", labelLineHeight: 13, labelOffset: -6.5 * (lines - 1)},
    }],
    value: ['x', {type: 'quantitative', scale: {zero: false, nice: true}, axis: {title: 'Mean height (m)'}}],
    tooltip: [{field: 'along', title: 'Condition'}, {field: 'value', title: 'Mean height (m)', format: '.1f'}],
  });
}

/** The Pareto front: agents that no other one beats in quality with as little energy, by rising energy. */
function paretoFront(rows) {
  const front = [];
  for (const row of [...rows].sort((a, b) => a.energy - b.energy || b.qos - a.qos))
    if (front.length === 0 || row.qos > front[front.length - 1].qos) front.push(row);
  return front;
}

/** Places of labels for points at these heights (px, from the top): in the same order, at least `gap` apart, within 0 to `bottom` if they fit. */
export function spread(heights, gap, bottom) {
  const order = heights.map((_, i) => i).sort((a, b) => heights[a] - heights[b]);
  const placed = [...heights];
  order.forEach((i, rank) => { if (rank > 0) placed[i] = Math.max(placed[i], placed[order[rank - 1]] + gap); });
  let limit = bottom;
  for (const i of order.reverse()) {
    placed[i] = Math.min(placed[i], limit);
    limit = placed[i] - gap;
  }
  return placed;
}

/** Mean quality against mean energy of every agent; the line joins the best of those that real UAVs can fly. Names stand at the right, each on a line of its own. */
export function energyChart(data, condition, context) {
  const agents = condition.views[context.view].agents;
  const names = agents.map((agent) => agent.name);
  const rows = agents.map((agent) => ({
    ...named(data, agent.name), energy: agent.metrics.energy, qos: agent.mean, ...ends(agent.ci95),
    text: interval(agent.ci95), privileged: isPrivileged(data, agent.name),
  }));
  const height = Math.max(300, 16 * rows.length);
  const reach = rows.flatMap((row) => [row.low ?? row.qos, row.high ?? row.qos]);
  const room = 0.05 * (Math.max(...reach) - Math.min(...reach)) || 0.5;
  const [low, high] = [Math.min(...reach) - room, Math.max(...reach) + room];
  const per_px = (high - low) / height;
  spread(rows.map((row) => (high - row.qos) / per_px), 14, height).forEach((px, i) => { rows[i].label = high - px * per_px; });
  const surface = surfaces[context.theme];
  const colour = {field: 'agent', type: 'nominal', scale: agentScales(data, context.theme, names).colour, legend: null};
  const x = {field: 'energy', type: 'quantitative', scale: {type: 'log', nice: false, padding: 30}, axis: {title: 'Energy per flight (kJ)', format: '~g', grid: false, values: [5, 10, 15, 20, 30, 40, 60, 100, 150, 200, 300]}};
  const y = (field) => ({field, type: 'quantitative', scale: {domain: [low, high], nice: false}, axis: {title: qosTitle(condition)}});
  const tooltip = [
    agentTip, {field: 'energy', title: 'Energy (kJ)', format: '.1f'},
    {field: 'qos', title: 'Mean', format: '.2f'}, {field: 'text', title: '95 % interval'},
  ];
  return {
    usermeta: {agents: names},
    height,
    data: {values: rows},
    layer: [
      {mark: {type: 'rule', strokeWidth: 0.8, opacity: 0.5}, encoding: {x, x2: {value: 'width'}, y: y('qos'), y2: {field: 'label'}, color: colour}},
      {data: {values: paretoFront(rows.filter((row) => !row.privileged))}, mark: {type: 'line', interpolate: 'step-after', strokeDash: [4, 3], strokeWidth: 1.4, color: surface.soft}, encoding: {x, y: y('qos'), order: {field: 'energy'}}},
      ...layerOf(rows, intervalKnown, {mark: {type: 'rule', strokeWidth: 1.6}, encoding: {x, y: y('low'), y2: {field: 'high'}, color: colour}}),
      {mark: {type: 'point', size: 75, strokeWidth: 2, opacity: 1}, encoding: {x, y: y('qos'), color: colour, fill: tierFill(data, colour, surface), tooltip}},
      {mark: {type: 'text', align: 'left', dx: 5, fontSize: 11, color: surface.ink, limit: labelLimit(context)}, encoding: {x: {value: 'width'}, y: y('label'), text: {field: 'shown'}}},
    ],
  };
}

/** The agents of a condition, and those that only flew over its worlds in other runs of this report. */
function agentsOver(data, condition, view) {
  const agents = [...condition.views[view].agents];
  for (const other of data.conditions)
    if (other !== condition && other.world === condition.world)
      agents.push(...(other.views[view]?.agents ?? []).filter((agent) => !agents.some((known) => known.name === agent.name)));
  return agents;
}

/** A row per agent and place; several for an agent that is told the site map, if there are maps with errors or gaps. */
function gainRows(data, experiment, view) {
  const rows = new Map();
  for (const condition of data.conditions) {
    if (condition.experiment !== experiment || !condition.views[view] || condition.qos_unit !== 'bit/s/Hz') continue;
    for (const agent of agentsOver(data, condition, view)) {
      if (!agent.gain || agent.name === 'min-height') continue;
      const told = shapeOf(data, agent.name) === 'half' && condition.site_map !== '' ? `, ${condition.site_map}` : '';
      const row = {
        agent: agent.name, row: marked(data, agent.name) + told, condition: condition.place.replaceAll(' per km²', ''), gain: agent.gain.mean,
        ...ends(agent.gain.ci95), text: signedInterval(agent.gain.ci95),
      };
      const key = JSON.stringify([row.condition, row.row]);
      if (!rows.has(key)) rows.set(key, row);
    }
  }
  return [...rows.values()];
}

/** Whether there is more than one condition to compare gains over. */
export function hasGains(data, experiment, view) {
  return new Set(gainRows(data, experiment, view).map((row) => row.condition)).size > 1;
}

/** The list in parts of about the same length, none longer than `most`. */
function inParts(list, most) {
  const length = Math.ceil(list.length / Math.ceil(list.length / most));
  return Array.from({length: Math.ceil(list.length / length)}, (_, i) => list.slice(i * length, (i + 1) * length));
}

const narrowest_column_px = 80;  // room for "200 buildings"

/** Gains over min-height of all agents, side by side for the generated conditions of one experiment, in as many rows as it takes. */
export function gainsOverview(data, experiment, context) {
  const rows = gainRows(data, experiment, context.view);
  const names = [...new Set(rows.map((row) => row.agent))];
  const conditions = [...new Set(rows.map((row) => row.condition))];
  const surface = surfaces[context.theme];
  const colour = {field: 'agent', type: 'nominal', scale: agentScales(data, context.theme, names).colour, legend: null};
  const reach = rows.flatMap((row) => [row.low ?? row.gain, row.high ?? row.gain, 0]);
  const x = (field) => ({field, type: 'quantitative', scale: {domain: [Math.min(...reach), Math.max(...reach)], nice: true}, axis: {title: null, tickCount: 4}});
  const order = byKnowledge(data).flatMap((agent) => [...new Set(rows.filter((row) => row.agent === agent.name).map((row) => row.row))]);
  const fontSize = context.width < 500 ? 11 : 12;
  const limit = Math.max(labelLimit(context), Math.round(0.46 * context.width));
  const labels = Math.min(limit, 0.565 * fontSize * Math.max(...order.map((row) => row.length))) + 12;
  const y = {field: 'row', type: 'nominal', sort: order, scale: {domain: order}, axis: {title: null, ticks: false, domain: false, grid: false, labelFontSize: fontSize, labelLimit: limit}};
  const tooltip = [
    {field: 'condition', title: 'Condition'}, {field: 'row', title: 'Agent'},
    {field: 'gain', title: 'Mean gain (bit/s/Hz)', format: '+.2f'}, {field: 'text', title: '95 % interval'},
  ];
  const parts = inParts(conditions, Math.max(1, Math.floor((context.width - labels) / (narrowest_column_px + 14))));
  const title = ['Gain over min-height on the same worlds (bit/s/Hz);', 'base stations (BS) and buildings per km²'];
  return {
    usermeta: {agents: names},
    autosize: {type: 'pad'},
    width: undefined,
    spacing: 26,
    vconcat: parts.map((part) => ({
      data: {values: rows.filter((row) => part.includes(row.condition))},
      spacing: 14,
      facet: {column: {field: 'condition', type: 'nominal', sort: conditions, header: {title: part === parts.at(-1) ? title : null, titleOrient: 'bottom', titleFontWeight: 500, titleColor: surface.ink, labelColor: surface.ink, labelFontSize: 11, labelExpr: "split(datum.label, ', ')"}}},
      spec: {
        width: Math.floor((context.width - labels) / parts[0].length) - 14,
        height: 20 * order.length,
        layer: [
          {data: {values: [{zero: 0}]}, mark: {type: 'rule', strokeDash: [4, 3], color: surface.soft}, encoding: {x: {field: 'zero', type: 'quantitative'}}},
          ...(rows.some(intervalKnown) ? [{transform: [{filter: 'isValid(datum.low)'}], mark: {type: 'rule', strokeWidth: 3}, encoding: {y, x: x('low'), x2: {field: 'high'}, color: colour, tooltip}}] : []),
          {mark: {type: 'point', size: 60, strokeWidth: 2, opacity: 1}, encoding: {y, x: x('gain'), color: colour, fill: tierFill(data, colour, surface), tooltip}},
        ],
      },
    })),
  };
}
