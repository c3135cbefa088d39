// The page: reads the data block, draws every section, redraws when the reader changes theme, trials or flight.

import {complete, defaultContext, flightCharts, statisticsCharts} from './charts.js';
import {gainsOverview, hasGains, meanHeightChart} from './charts_statistics.js';
import {choice, h} from './dom.js';
import {slug} from './format.js';
import {marked, marksExplained} from './privilege.js';
import {claimsList, leftOutList, missingSection, publishedTable, selectionRemark, summaryTable} from './sections.js';

const data = JSON.parse(document.getElementById('report-data').textContent);
const titles = {qos: 'Per-trial mean', gain: 'Paired gain over min-height', profile: 'Performance profile', energy: 'Quality against energy'};

/** What the reader chose; kept in the address (#theme=dark&trials=selected&condition=1&agent=dqn) so that it can be shared. */
const state = readState();
let pending = [];

function readState() {
  const given = new URLSearchParams(location.hash.slice(1));
  const preferred = window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  const theme = ['light', 'dark'].includes(given.get('theme')) ? given.get('theme') : null;
  const canSelect = data.conditions.some((condition) => condition.views.selected);
  const wanted = Number(given.get('condition') ?? data.shown_condition);
  const condition = Number.isInteger(wanted) && data.conditions[wanted] ? wanted : data.shown_condition;
  return {theme: theme ?? preferred, themeChosen: theme !== null, view: canSelect && given.get('trials') === 'selected' ? 'selected' : 'all', condition, agent: given.get('agent')};
}

function change(part) {
  Object.assign(state, part);
  const address = new URLSearchParams();
  if (state.themeChosen) address.set('theme', state.theme);
  if (state.view === 'selected') address.set('trials', 'selected');
  if (state.condition !== data.shown_condition) address.set('condition', state.condition);
  if (state.agent) address.set('agent', state.agent);
  history.replaceState(null, '', String(address) !== '' ? `#${address}` : location.pathname + location.search);
  draw();
}

function flightContext(condition) {
  const context = {...defaultContext(data, condition.flight), theme: state.theme, view: state.view};
  const chosen = condition.flight?.agents.find((agent) => agent.name === state.agent);
  if (chosen) context.agent = chosen.name;
  if (chosen?.learning) context.learner = chosen.name;
  return context;
}

/** A figure whose chart is drawn once the figure has a width. */
function figure(name, title, build) {
  const chart = h('div', {class: 'chart', 'data-chart': name});
  pending.push({chart, name, build});
  return h('figure', {}, h('figcaption', {}, title), chart);
}

async function drawCharts() {
  const charts = pending;
  pending = [];
  const failures = [];
  await Promise.all(charts.map(async ({chart, name, build}) => {
    try {
      const context = {width: Math.max(240, chart.clientWidth - 2), theme: state.theme, view: state.view};
      await vegaEmbed(chart, complete(build(context), context), {
        renderer: 'svg', downloadFileName: name,
        actions: {export: {svg: true, png: true}, source: false, compiled: false, editor: false},
      });
    } catch (error) {
      chart.textContent = `This chart could not be drawn: ${error.message}`;
      failures.push(`${name}: ${error.message}`);
    }
  }));
  document.body.toggleAttribute('data-ready', failures.length === 0);
  if (failures.length > 0) document.body.dataset.error = failures.join('; ');
}

function header() {
  const canSelect = data.conditions.some((condition) => condition.views.selected);
  const other = state.theme === 'dark' ? 'light' : 'dark';
  return h('header', {},
    h('div', {class: 'bar'},
      h('h1', {}, data.title),
      h('button', {type: 'button', class: 'toggle', 'aria-label': `Switch to ${other} colours`, onclick: () => change({theme: other, themeChosen: true})}, state.theme === 'dark' ? '☀ Light' : '☾ Dark')),
    data.experiments.map((experiment) => h('p', {class: 'soft'}, h('strong', {}, experiment.name), experiment.description ? ` – ${experiment.description}` : '')),
    h('div', {class: 'bar controls'},
      canSelect ? choice('Trials', [{value: 'all', text: 'all trials'}, {value: 'selected', text: `only where ${data.learner} beat constant-120`}], state.view, (view) => change({view})) : null,
      h('nav', {'aria-label': 'Sections'}, [['results', 'Results'], ['published', 'Published values'], ['claims', 'Claims'], ['flight', 'One flight']].map(([id, text]) => h('a', {href: `#${id}`, onclick: (event) => jump(event, id)}, text)))));
}

/** Scrolls without changing the address, which holds the reader's choices. */
function jump(event, id) {
  event.preventDefault();
  document.getElementById(id).scrollIntoView({behavior: 'smooth'});
}

function chartName(condition, id) {
  return `${slug(data.experiments[condition.experiment].name)}-${slug(condition.name)}-${id}`;
}

function experimentResults(experiment, index) {
  const conditions = data.conditions.filter((condition) => condition.experiment === index && condition.views[state.view]);
  if (conditions.length === 0) return h('p', {class: 'soft'}, `${experiment.name}: no flights to show.`);
  const parts = [];
  if (hasGains(data, index, state.view))
    parts.push(h('h4', {}, 'Gains over min-height in all conditions'), explain('gain'),
      h('div', {class: 'grid wide'}, figure(`${slug(experiment.name)}-gains`, 'Mean over trials, with 95 % intervals', (context) => gainsOverview(data, index, context))));
  for (const chart of statisticsCharts) {
    const fitting = conditions.filter((condition) => chart.fits(condition.views[state.view]));
    if (fitting.length === 0) continue;
    parts.push(h('h4', {}, titles[chart.id]), explain(chart.id),
      h('div', {class: 'grid'}, fitting.map((condition) => figure(chartName(condition, chart.id), condition.label, (context) => chart.build(data, condition, context)))));
  }
  parts.push(h('h4', {}, 'Mean flying height'),
    h('div', {class: 'grid wide'}, figure(`${slug(experiment.name)}-mean-height`, 'Mean over trials, with 95 % intervals', (context) => meanHeightChart(data, index, context))));
  return h('div', {class: 'experiment'}, data.experiments.length > 1 ? h('h3', {}, experiment.name) : null, parts,
    h('h4', {}, 'Numbers'), conditions.map((condition) => summaryTable(data, condition, {theme: state.theme, view: state.view})));
}

function explain(id) {
  const texts = {
    qos: 'Each value behind a box is the mean of one flight. Box: quartiles and median; whiskers: the last value within 1.5 box lengths; diamond: mean.',
    gain: 'Difference to min-height on the same worlds; the bar is the 95 % bootstrap interval of the mean.',
    profile: 'The share of trials whose mean exceeds a threshold: higher is better everywhere, crossing lines mean that no agent is best for all.',
    energy: 'Mean of all flights. No UAV without privileged knowledge is above and left of the line. Energy: rotary-wing power at constant speed over ground, plus climbing (docs/learners.md).',
  };
  return h('p', {class: 'soft'}, texts[id]);
}

function resultsSection() {
  return h('section', {id: 'results'}, h('h2', {}, 'Results'),
    state.view === 'selected' ? selectionRemark(data) : null,
    h('p', {class: 'soft'}, marksExplained(data), ' Where nothing varies – one trial, or the same result in all – there is no interval.'),
    data.experiments.map(experimentResults));
}

function publishedSection() {
  const context = {theme: state.theme, view: state.view};
  return h('section', {id: 'published'}, h('h2', {}, 'Published values beside ours'),
    h('p', {class: 'soft'}, `Source: ${data.published.source}. Compared are the paper's own worlds, flights and agents, with at least ${data.published.least_trials} trials. Intervals are ours (95 %, bootstrap). A value agrees if our whole interval lies within the published value's ± (or the rounding of its last digit), and disagrees if all of it lies outside; otherwise these trials cannot tell. The published trials were selected: in each of them the learner beats constant-120; `,
      state.view === 'all' ? 'ours are all counted. The switch at the top shows ours selected by the same rule.' : 'ours are selected here by the same rule.'),
    publishedTable(data, context), leftOutList(data, context));
}

function claimsSection() {
  return h('section', {id: 'claims'}, h('h2', {}, 'Published claims'),
    h('p', {class: 'soft'}, 'Each verdict is computed from the 95 % intervals of this report: supported if every interval lies on the claimed side, contradicted if at least one lies wholly on the other, otherwise the data cannot decide. A claim is supported only if all worlds and agents that it speaks of have flown, and only the paper\'s own count. One interval in twenty misses the truth by chance: look at the single comparisons before you quarrel with a verdict that hangs on one of them.'),
    claimsList(data, {view: state.view}));
}

function flightSection() {
  const condition = data.conditions[state.condition];
  const context = flightContext(condition);
  const flight = condition.flight;
  const section = h('section', {id: 'flight'}, h('h2', {}, 'One flight'),
    h('div', {class: 'bar controls'},
      choice('Condition', data.conditions.map((other, index) => ({value: index, text: data.experiments.length > 1 ? `${data.experiments[other.experiment].name}: ${other.label}` : other.label})), state.condition, (value) => change({condition: Number(value)})),
      flight ? choice('Agent', flight.agents.map((agent) => ({value: agent.name, text: marked(data, agent.name)})), context.agent, (agent) => change({agent})) : null));
  if (!flight) section.append(h('p', {class: 'soft'}, 'No flight of this trial is stored yet for this condition.'));
  else section.append(
    h('p', {class: 'soft'}, `Trial ${flight.trial}: all agents on the same world. Click an agent in a legend to see it alone, shift-click to add another.`),
    h('div', {class: 'grid wide'}, flightCharts.filter((chart) => chart.fits(flight, context))
      .map((chart) => figure(chartName(condition, chart.id), chart.title(condition, context), (size) => chart.build(data, condition, {...context, ...size})))));
  return section;
}

function footer() {
  return h('footer', {}, data.experiments.map((experiment) => h('p', {},
    `${experiment.name}: experiment ${experiment.id}, seed ${experiment.seed}, ${experiment.flights_stored} of ${experiment.flights_expected} flights, digest `, h('code', {}, experiment.digest))),
  h('p', {}, `Written by ${data.build}. Every chart can be saved as SVG or PNG from the menu at its corner.`));
}

/** Redraws everything; the height is kept meanwhile so that the reader's place does not jump. */
function draw() {
  document.documentElement.dataset.theme = state.theme;
  document.body.removeAttribute('data-ready');
  const main = document.querySelector('main');
  main.style.minHeight = `${main.scrollHeight}px`;
  main.replaceChildren(...[header(), missingSection(data), resultsSection(), publishedSection(), claimsSection(), flightSection(), footer()].filter(Boolean));
  drawCharts().finally(() => { main.style.minHeight = ''; });
}

function redrawWhenWidthChanges() {
  let width = window.innerWidth;
  let timer = 0;
  window.addEventListener('resize', () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    clearTimeout(timer);
    timer = setTimeout(draw, 200);
  });
}

window.addEventListener('error', (event) => { document.body.dataset.error = event.message; });
window.addEventListener('unhandledrejection', (event) => { document.body.dataset.error = String(event.reason); });
window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => {
  if (!state.themeChosen) change({theme: event.matches ? 'dark' : 'light'});
});
redrawWhenWidthChanges();
document.title = `${data.title} – Aloft`;
draw();
