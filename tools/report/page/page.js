// The page: reads the data block, draws every section, redraws when the reader changes theme, trials or flight.

import {complete, defaultContext, flightCharts, statisticsCharts} from './charts.js';
import {gainsOverview, hasGains, meanHeightChart} from './charts_statistics.js';
import {sweptCharts} from './charts_swept.js';
import {choice, h, ticks} from './dom.js';
import {filtered, readFilter, writeFilter} from './filter.js';
import {slug} from './format.js';
import {marked, marksExplained} from './privilege.js';
import {agentName, claimsList, leftOutList, missingSection, publishedTable, selectionRemark, summaryTable} from './sections.js';

const everything = JSON.parse(document.getElementById('report-data').textContent);
const titles = {qos: 'Per-trial mean', gain: 'Paired gain over min-height', profile: 'Performance profile', energy: 'Quality against energy', heights: 'Heights flown'};

/** What the reader chose; kept in the address (#theme=dark&trials=selected&condition=1&agent=dqn&agents=dqn,planner&conditions=0,1) so that it can be shared. */
const state = readState();

/** What of everything the reader wants to see. */
let data = filtered(everything, state);
let pending = [];
let drawing = 0;  // counts the drawings, so that a new one stops the one before

function readState() {
  const given = new URLSearchParams(location.hash.slice(1));
  const preferred = window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  const theme = ['light', 'dark'].includes(given.get('theme')) ? given.get('theme') : null;
  const wanted = Number(given.get('condition') ?? everything.shown_condition);
  const condition = Number.isInteger(wanted) && everything.conditions[wanted] ? wanted : everything.shown_condition;
  return {theme: theme ?? preferred, themeChosen: theme !== null, view: canSelect() && given.get('trials') === 'selected' ? 'selected' : 'all', condition, agent: given.get('agent'), ...readFilter(everything, given)};
}

function canSelect() {
  return everything.conditions.some((condition) => condition.views.selected);
}

function change(part) {
  Object.assign(state, part);
  const address = new URLSearchParams();
  if (state.themeChosen) address.set('theme', state.theme);
  if (state.view === 'selected') address.set('trials', 'selected');
  if (state.condition !== everything.shown_condition) address.set('condition', state.condition);
  if (state.agent) address.set('agent', state.agent);
  writeFilter(state, address);
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
  pending.push({chart, name, title, build});
  return h('figure', {}, h('figcaption', {}, title), chart);
}

/** Draws one chart after the other, from the top, so that the page can be used meanwhile. */
async function drawCharts() {
  const charts = pending;
  const turn = ++drawing;
  const failures = [];
  pending = [];
  for (const {chart, name, title, build} of charts) {
    try {
      const context = {width: Math.max(240, chart.clientWidth - 2), theme: state.theme, view: state.view};
      await vegaEmbed(chart, {...complete(data, build(context), context), description: title}, {
        renderer: 'svg', downloadFileName: name,
        actions: {export: {svg: true, png: true}, source: false, compiled: false, editor: false},
      });
      chart.querySelector('summary').setAttribute('aria-label', `Save: ${title}`);
    } catch (error) {
      chart.textContent = `This chart could not be drawn: ${error.message}`;
      failures.push(`${name}: ${error.message}`);
    }
    await new Promise((resolve) => { setTimeout(resolve, 0); });
    if (turn !== drawing) return;
  }
  document.body.toggleAttribute('data-ready', failures.length === 0);
  if (failures.length > 0) document.body.dataset.error = failures.join('; ');
}

function header() {
  const other = state.theme === 'dark' ? 'light' : 'dark';
  return h('header', {},
    h('div', {class: 'bar'},
      h('h1', {}, data.title),
      h('button', {type: 'button', class: 'toggle', id: 'theme', 'aria-label': `Switch to ${other} colours`, onclick: () => change({theme: other, themeChosen: true})}, state.theme === 'dark' ? '☀ Light' : '☾ Dark')),
    data.experiments.map((experiment) => h('p', {class: 'soft'}, h('strong', {}, experiment.name), experiment.description ? ` – ${experiment.description}` : '')),
    h('div', {class: 'bar controls'},
      canSelect() ? choice('Trials', [{value: 'all', text: 'all trials'}, {value: 'selected', text: `only where ${data.learner} beat constant-120`}], state.view, (view) => change({view})) : null,
      ticks('Agents', everything.agents.map(({name}) => ({value: name, text: agentName(everything, name, state.theme)})), state.agents, (agents) => change({agents})),
      everything.conditions.length > 1 ? ticks('Conditions', everything.conditions.map((condition, value) => ({value, text: conditionName(condition)})), state.conditions, (conditions) => change({conditions})) : null,
      h('nav', {'aria-label': 'Sections'}, [['results', 'Results'], ['published', 'Published values'], ['claims', 'Claims'], ['flight', 'One flight']].map(([id, text]) => h('a', {href: `#${id}`, onclick: (event) => jump(event, id)}, text)))));
}

function conditionName(condition) {
  return everything.experiments.length > 1 ? `${everything.experiments[condition.experiment].name}: ${condition.label}` : condition.label;
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
  const part = (text) => h(data.experiments.length > 1 ? 'h4' : 'h3', {class: 'part'}, text);
  if (hasGains(data, index, state.view))
    parts.push(part('Gains over min-height in all conditions'), explain('gain'),
      h('div', {class: 'grid whole'}, figure(`${slug(experiment.name)}-gains`, 'Mean over trials, with 95 % intervals', (context) => gainsOverview(data, index, context))));
  const swept = sweptCharts(data, index, state.view);
  if (swept.length > 0)
    parts.push(part('What the swept parameters do'), explain('swept'),
      h('div', {class: 'grid whole'}, swept.map((chart) => figure(`${slug(experiment.name)}-${chart.id}`, chart.title, chart.build))));
  for (const chart of statisticsCharts) {
    const fitting = conditions.filter((condition) => chart.fits(condition.views[state.view]));
    if (fitting.length === 0) continue;
    parts.push(part(titles[chart.id]), explain(chart.id),
      h('div', {class: 'grid'}, fitting.map((condition) => figure(chartName(condition, chart.id), condition.label, (context) => chart.build(data, condition, context)))));
  }
  parts.push(part('Mean flying height'),
    h('div', {class: 'grid whole'}, figure(`${slug(experiment.name)}-mean-height`, 'Mean over trials, with 95 % intervals', (context) => meanHeightChart(data, index, context))));
  return h('div', {class: 'experiment'}, data.experiments.length > 1 ? h('h3', {}, experiment.name) : null, parts,
    part('Numbers'), conditions.map((condition) => summaryTable(data, condition, {theme: state.theme, view: state.view})));
}

function explain(id) {
  const texts = {
    swept: 'Means over trials; bars are 95 % bootstrap intervals. With more than two swept parameters, lines go over one of them where the others stay.',
    qos: 'Each value behind a box is the mean of one flight. Box: quartiles and median; whiskers: the last value within 1.5 box lengths; diamond: mean.',
    gain: 'Difference to min-height on the same worlds; the bar is the 95 % bootstrap interval of the mean.',
    profile: 'The share of trials whose mean exceeds a threshold: higher is better everywhere, crossing lines mean that no agent is best for all.',
    energy: 'Mean of all flights. No UAV without privileged knowledge is above and left of the line. Energy: rotary-wing power at constant speed over ground, plus climbing (docs/learners.md).',
    heights: 'How many of the steps of all flights were flown at each height; the most frequent height of each agent fills its row. It shows what agents make of channels that change abruptly with height, as those of TR 36.777 do at 100 m (docs/fidelity.md).',
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
    publishedTable(everything, context), leftOutList(everything, context));
}

function claimsSection() {
  return h('section', {id: 'claims'}, h('h2', {}, 'Published claims'),
    h('p', {class: 'soft'}, 'Each verdict is computed from the 95 % intervals of this report: supported if every interval lies on the claimed side, contradicted if at least one lies wholly on the other, otherwise the data cannot decide. A claim is supported only if all worlds and agents that it speaks of have flown, and only the paper\'s own count. One interval in twenty misses the truth by chance: look at the single comparisons before you quarrel with a verdict that hangs on one of them.'),
    claimsList(everything, {view: state.view}));
}

function flightSection() {
  const condition = data.conditions.find(({index}) => index === state.condition) ?? data.conditions[0];
  const context = flightContext(condition);
  const flight = condition.flight;
  const section = h('section', {id: 'flight'}, h('h2', {}, 'One flight'),
    h('div', {class: 'bar controls'},
      choice('Condition', data.conditions.map((other) => ({value: other.index, text: conditionName(other)})), condition.index, (value) => change({condition: Number(value)})),
      flight ? choice('Agent', flight.agents.map((agent) => ({value: agent.name, text: marked(data, agent.name)})), context.agent, (agent) => change({agent})) : null));
  if (!flight) section.append(h('p', {class: 'soft'}, 'No flight of this trial is stored yet for this condition.'));
  else section.append(
    h('p', {class: 'soft'}, `Trial ${flight.trial}: all agents on the same world. Click an agent in a legend to see it alone, shift-click to add another.`),
    ...[true, undefined].map((wide) => h('div', {class: wide ? 'grid whole' : 'grid'}, flightCharts.filter((chart) => chart.wide === wide && chart.fits(flight, context))
      .map((chart) => figure(chartName(condition, chart.id), chart.title(condition, context), (size) => chart.build(data, condition, {...context, ...size}))))));
  return section;
}

function footer() {
  return h('footer', {}, data.experiments.map((experiment) => h('p', {},
    `${experiment.name}: experiment ${experiment.id}, seed ${experiment.seed}, ${experiment.flights_stored} of ${experiment.flights_expected} flights, digest `, h('code', {}, experiment.digest))),
  h('p', {}, `Written by ${data.build}. Every chart can be saved as SVG or PNG from the menu at its corner.`));
}

/** What the filter leaves: results and one flight. Published values and claims are about the whole run. */
function filteredSections() {
  if (data.agents.length > 0 && data.conditions.length > 0) return [resultsSection(), publishedSection(), claimsSection(), flightSection()];
  return [h('section', {class: 'notice', id: 'results'}, h('p', {}, 'Nothing is chosen: tick agents and conditions at the top.')), publishedSection(), claimsSection()];
}

/** Redraws everything; the height, the focus and what is unfolded are kept so that the reader's place does not jump. */
function draw() {
  document.documentElement.dataset.theme = state.theme;
  document.body.removeAttribute('data-ready');
  data = filtered(everything, state);
  const main = document.querySelector('main');
  const focused = document.activeElement?.id;
  const unfolded = [...main.querySelectorAll('details[id][open]')].map((details) => details.id);
  main.style.minHeight = `${main.scrollHeight}px`;
  main.replaceChildren(...[header(), missingSection(data), ...filteredSections(), footer()].filter(Boolean));
  for (const id of unfolded) document.getElementById(id).open = true;
  if (focused) document.getElementById(focused)?.focus({preventScroll: true});
  document.getElementById('status').textContent = `Shown: ${data.agents.length} of ${everything.agents.length} agents in ${data.conditions.length} of ${everything.conditions.length} conditions`;
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
