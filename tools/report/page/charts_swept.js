// Charts over the parameters that an experiment sweeps: lines over one, cells over two.

import {gainOf, linesWithIntervals, qosTitle} from './charts_statistics.js';
import {signed} from './format.js';
import {byKnowledge, named} from './privilege.js';
import {surfaces} from './theme.js';

/** A route of which 0 points are told ahead is told as a whole: no place on an axis. */
const isOnAxis = (key, value) => value !== undefined && (key !== 'site_map_route_points' || value > 0);

/** What one experiment sweeps: [{keys, conditions}], one entry for one or two parameters; for more, one per parameter, over the most conditions that differ in it alone. */
export function sweeps(data, experiment, view) {
  const conditions = data.conditions.filter((condition) => condition.experiment === experiment && condition.views[view] && Object.keys(condition.parameters).length > 0);
  const valuesOf = (key, some) => new Set(some.map((condition) => condition.parameters[key]).filter((value) => isOnAxis(key, value)));
  const keys = Object.keys(data.parameter_titles).filter((key) => valuesOf(key, conditions).size > 1);
  if (keys.length === 0) return [];
  if (keys.length <= 2) return [{keys, conditions: conditions.filter((condition) => keys.every((key) => isOnAxis(key, condition.parameters[key])))}];
  return keys.map((key) => {
    const groups = new Map();
    for (const condition of conditions.filter((one) => isOnAxis(key, one.parameters[key]))) {
      const others = JSON.stringify(keys.filter((other) => other !== key).map((other) => condition.parameters[other]));
      groups.set(others, [...(groups.get(others) ?? []), condition]);
    }
    return {keys: [key], conditions: [...groups.values()].reduce((a, b) => (valuesOf(key, b).size > valuesOf(key, a).size ? b : a))};
  }).filter(({keys: [key], conditions: some}) => valuesOf(key, some).size > 1);
}

/** What is drawn over one parameter. */
const quantities = {
  quality: {title: 'Mean', axis: (condition) => qosTitle(condition), format: '.2f', of: (agent) => ({value: agent.mean, ci95: agent.ci95})},
  gain: {title: 'Mean gain', axis: (condition) => `Gain over min-height (${condition.qos_unit})`, format: '+.2f', of: gainOf},
  height: {title: 'Mean height (m)', axis: () => 'Mean height (m)', format: '.1f', of: (agent) => ({value: agent.metrics['mean height'], ci95: agent.height_ci95_m})},
};

/** One quantity of every agent over one swept parameter, with 95 % intervals. */
export function linesOver(data, {keys: [key], conditions}, quantity, context) {
  const {title, axis, format, of} = quantities[quantity];
  const parameter = data.parameter_titles[key];
  const rows = conditions.flatMap((condition) => condition.views[context.view].agents.map((agent) => ({...named(data, agent.name), along: condition.parameters[key], order: condition.parameters[key], ...of(agent)})))
    .filter((row) => Number.isFinite(row.value));
  const values = [...new Set(rows.map((row) => row.along))].sort((a, b) => a - b);
  return linesWithIntervals(data, context, rows, {
    height: 320,
    along: ['x', {field: 'along', type: 'quantitative', scale: {zero: false, nice: false, padding: 20}, axis: {title: parameter, values, grid: false}}],
    value: ['y', {type: 'quantitative', scale: {zero: false, nice: true}, axis: {title: axis(conditions[0])}}],
    tooltip: [{field: 'along', title: parameter}, {field: 'value', title, format}],
  });
}

/** Gain over min-height at every pair of two swept parameters: cells with numbers, one block per agent. */
export function cellsOver(data, {keys: [across, up], conditions}, context) {
  const rows = conditions.flatMap((condition) => condition.views[context.view].agents.map((agent) => ({
    ...named(data, agent.name), across: condition.parameters[across], up: condition.parameters[up], gain: gainOf(agent).value,
  }))).filter((row) => Number.isFinite(row.gain)).map((row) => ({...row, text: signed(Number(row.gain.toFixed(1)) || 0, 1)}));
  const names = [...new Set(rows.map((row) => row.agent))];
  const low = Math.min(...rows.map((row) => row.gain));
  const high = Math.max(...rows.map((row) => row.gain));
  const count = (field) => new Set(rows.map((row) => row[field])).size;
  const surface = surfaces[context.theme];
  const dark = context.theme === 'dark';
  const width = (context.width < 500 ? 36 : 44) * count('across');
  const strong = `datum.gain > ${low + (dark ? 0.5 : 0.72) * (high - low)}`;  // where the paper's colour is the easier one to read
  const axis = (key) => ({title: data.parameter_titles[key], titleFontSize: 11, labelAngle: 0, labelFontSize: 11, grid: false, domain: false, ticks: false});
  const x = {field: 'across', type: 'ordinal', axis: axis(across)};
  const y = {field: 'up', type: 'ordinal', sort: 'descending', axis: axis(up)};
  const tooltip = [{field: 'shown', title: 'Agent'}, {field: 'across', title: data.parameter_titles[across]}, {field: 'up', title: data.parameter_titles[up]}, {field: 'gain', title: 'Mean gain', format: '+.2f'}];
  return {
    usermeta: {agents: names},
    autosize: {type: 'pad'},
    width: undefined,
    data: {values: rows},
    facet: {field: 'shown', type: 'nominal', sort: byKnowledge(data).map((agent) => named(data, agent.name).shown), header: {title: null, labelFontSize: 12, labelColor: surface.ink, labelLimit: width + 50}},
    columns: Math.max(1, Math.floor((context.width + 14) / (width + 72))),
    spacing: 14,
    spec: {
      width, height: 26 * count('up'),
      layer: [
        {mark: {type: 'rect'}, encoding: {x, y, tooltip, color: {field: 'gain', type: 'quantitative', scale: {domain: [low, high], range: [surface.background, dark ? '#9ec5ff' : '#0058a3'], interpolate: 'rgb'}, legend: {title: `Gain over min-height (${conditions[0].qos_unit})`, orient: 'top', titleLimit: context.width, gradientLength: Math.min(260, context.width - 80)}}}},
        {mark: {type: 'text', fontSize: 11}, encoding: {x, y, tooltip, text: {field: 'text'}, color: {condition: {test: strong, value: surface.background}, value: surface.ink}}},
      ],
    },
    resolve: {axis: {x: 'independent', y: 'independent'}},
  };
}

/** All charts over swept parameters: [{id, title, build(context)}]. */
export function sweptCharts(data, experiment, view) {
  return sweeps(data, experiment, view).flatMap((sweep) => {
    const over = sweep.keys.map((key) => data.parameter_titles[key].toLowerCase()).join(' and ');
    const id = sweep.keys.join('-').replaceAll('_', '-');
    const hasGain = sweep.conditions.some((condition) => condition.views[view].agents.some((agent) => Number.isFinite(gainOf(agent).value)));
    if (sweep.keys.length === 2) return hasGain ? [{id: `gain-swept-${id}`, title: `Gain over min-height by ${over}`, build: (context) => cellsOver(data, sweep, context)}] : [];
    const lines = (quantity, title) => ({id: `${quantity}-swept-${id}`, title: `${title} over ${over}${besides(data, experiment, sweep)}`, build: (context) => linesOver(data, sweep, quantity, context)});
    return [lines('quality', 'Mean'), ...(hasGain ? [lines('gain', 'Gain over min-height')] : []), lines('height', 'Mean flying height')];
  });
}

/** Where the other parameters stand, if lines are drawn over some of the conditions only. */
function besides(data, experiment, {keys: [key], conditions}) {
  const others = Object.keys(data.parameter_titles).filter((other) => other !== key && data.conditions.some((condition) => condition.experiment === experiment && condition.parameters[other] !== undefined && condition.parameters[other] !== conditions[0].parameters[other]));
  if (others.length === 0) return '';
  return `; ${others.map((other) => `${data.parameter_titles[other].toLowerCase()}: ${conditions[0].parameters[other]}`).join(', ')}`;
}
