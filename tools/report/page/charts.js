// The list of all charts of a report: the page and the SVG export draw from it.

import {boxPlot, energyChart, gainChart, gainsOverview, hasGains, heightHistogram, meanHeightChart, performanceProfile} from './charts_statistics.js';
import {cityMap, epsilonCurve, heatMap, heightOverSteps, lossCurve, qValueCurves, qosOverSteps} from './charts_flight.js';
import {sweptCharts} from './charts_swept.js';
import {marked, tierNote} from './privilege.js';
import {chartConfig} from './theme.js';
import {slug} from './format.js';

const smooth = 'mean of the last 10 steps';

/** One chart per condition, over its trials. */
export const statisticsCharts = [
  {id: 'qos', build: boxPlot, fits: (view) => view.agents.length > 0},
  {id: 'gain', build: gainChart, fits: (view) => view.agents.some((agent) => agent.gain && agent.name !== 'min-height')},
  {id: 'profile', build: performanceProfile, fits: (view) => view.agents.length > 0 && view.trials > 1},
  {id: 'energy', build: energyChart, fits: (view) => view.agents.length > 1},
  {id: 'heights', build: heightHistogram, fits: (view) => view.agents.length > 0},
];

/** Charts of the chosen flight of a condition; `wide` ones are as wide as the page. */
export const flightCharts = [
  {id: 'height-over-steps', wide: true, title: () => 'Height over steps', build: heightOverSteps, fits: () => true},
  {id: 'qos-over-steps', wide: true, title: (condition) => `${condition.qos_name} over steps (${smooth})`, build: qosOverSteps, fits: () => true},
  {id: 'heat-map', wide: true, title: (condition, context) => `${condition.qos_name} at every height, and the heights flown by ${flownBy(condition, context)}`, build: heatMap, fits: () => true},
  {id: 'city', title: (condition, context) => `The city from above, and the base stations that served ${context.shown(context.agent)}`, build: cityMap, fits: (flight) => flight.city !== null},
  {id: 'epsilon', title: (condition, context) => `${context.shown(context.learner)}: exploration rate`, build: epsilonCurve, fits: learns},
  {id: 'loss', title: (condition, context) => `${context.shown(context.learner)}: training loss`, build: lossCurve, fits: trains},
  {id: 'q-values', title: (condition, context) => `${context.shown(context.learner)}: Q-values of the three actions`, build: qValueCurves, fits: learns},
];

function flownBy(condition, context) {
  const shown = condition.flight.agents.map((agent) => agent.name).filter((name) => name === context.agent || ['one-step-ahead', 'planner'].includes(name));
  return shown.map(context.shown).join(', ');
}

function learns(flight, context) {
  return flight.agents.some((agent) => agent.name === context.learner && agent.learning);
}

/** There is no loss before the memory holds a minibatch. */
function trains(flight, context) {
  return flight.agents.some((agent) => agent.name === context.learner && agent.learning && agent.learning.loss.some((loss) => loss > 0));
}

/** What a report shows unless the reader chooses otherwise. */
export function defaultContext(data, flight) {
  const names = flight ? flight.agents.map((agent) => agent.name) : [];
  const learners = flight ? flight.agents.filter((agent) => agent.learning).map((agent) => agent.name) : [];
  const learner = learners.includes(data.learner) ? data.learner : learners[0] ?? null;
  return {learner, agent: learner ?? (names.includes(data.learner) ? data.learner : names[0]), shown: (name) => marked(data, name)};
}

/** A complete Vega-Lite specification: size, theme, chart, and under it what the marks of its agents mean. */
export function complete(data, spec, context) {
  const note = tierNote(data, spec.usermeta.agents);
  return {
    $schema: 'https://vega.github.io/schema/vega-lite/v6.json',
    width: context.width,
    autosize: {type: 'fit-x', contains: 'padding'},
    config: chartConfig(context.theme),
    ...(note.length > 0 ? {title: {text: note, orient: 'bottom', anchor: 'start', fontSize: 11, fontWeight: 400}} : {}),
    ...spec,
  };
}

/** Every chart as {name, spec}: what `--svg` writes. */
export function allCharts(data, base) {
  const charts = [];
  const add = (name, spec, context) => charts.push({name, spec: complete(data, spec, context)});
  data.experiments.forEach((experiment, index) => {
    const flown = data.conditions.some((condition) => condition.experiment === index && condition.views[base.view]);
    if (flown) add(`${slug(experiment.name)}-mean-height`, meanHeightChart(data, index, base), base);
    for (const chart of sweptCharts(data, index, base.view)) add(`${slug(experiment.name)}-${chart.id}`, chart.build(base), base);
    if (hasGains(data, index, base.view)) add(`${slug(experiment.name)}-gains`, gainsOverview(data, index, base), base);
  });
  for (const condition of data.conditions) {
    const prefix = `${slug(data.experiments[condition.experiment].name)}-${slug(condition.name)}`;
    const view = condition.views[base.view];
    for (const chart of statisticsCharts)
      if (view && chart.fits(view)) add(`${prefix}-${chart.id}`, chart.build(data, condition, base), base);
    if (!condition.flight) continue;
    const context = {...base, ...defaultContext(data, condition.flight)};
    for (const chart of flightCharts)
      if (chart.fits(condition.flight, context)) add(`${prefix}-${chart.id}`, chart.build(data, condition, context), context);
  }
  return charts;
}
