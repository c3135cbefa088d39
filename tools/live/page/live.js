// The page of `aloft live`: finds out what the server shows, and makes the tabs.

import {h} from '../../report/page/dom.js';
import {fetched} from './fetched.js';
import {LiveFlight} from './live_flight.js';
import {Replay} from './replay.js';
import {Results} from './results.js';
import {RunTab} from './run.js';
import {takeToken} from './swap.js';

const state = readState();
const token = takeToken(new URLSearchParams(location.hash.slice(1)).get('token'));
const main = document.querySelector('main');
let tabs = [];

/** What is shown; kept in the address, so that it can be shared: #tab=flight&condition=2&trial=7&agent=dqn&step=40. */
function readState() {
  const given = new URLSearchParams(location.hash.slice(1));
  const number = (name) => (/^\d+$/.test(given.get(name) ?? '') ? Number(given.get(name)) : null);
  const preferred = window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  const theme = ['light', 'dark'].includes(given.get('theme')) ? given.get('theme') : null;
  return {tab: given.get('tab'), condition: number('condition') ?? 0, trial: number('trial'), agent: given.get('agent'), worker: given.get('worker'), stream: number('stream'), step: number('step'), theme: theme ?? preferred, themeChosen: theme !== null};
}

function writeState() {
  const address = new URLSearchParams();
  if (state.themeChosen) address.set('theme', state.theme);
  for (const name of ['tab', ...(state.tab === 'live' ? ['worker', 'stream'] : ['condition', 'trial', 'agent', 'step'])]) if (state[name] !== null && state[name] !== undefined) address.set(name, state[name]);
  history.replaceState(null, '', `#${address}`);
}

function choose(name) {
  state.tab = tabs.some((tab) => tab.name === name) ? name : tabs[0].name;
  for (const tab of tabs) {
    const chosen = tab.name === state.tab;
    tab.button.setAttribute('aria-selected', chosen);
    tab.button.tabIndex = chosen ? 0 : -1;
    tab.element.hidden = !chosen;
    if (!chosen) tab.closed?.();
  }
  writeState();
  return tabs.find((tab) => tab.name === state.tab).opened();
}

function tabList() {
  const list = h('div', {role: 'tablist', 'aria-label': 'Views'});
  tabs.forEach((tab, index) => {
    tab.element.id = `tab-${tab.name}`;
    tab.element.setAttribute('role', 'tabpanel');
    tab.button = h('button', {type: 'button', role: 'tab', 'aria-controls': tab.element.id, onclick: () => choose(tab.name)}, tab.title);
    tab.button.addEventListener('keydown', (event) => {
      const move = {ArrowRight: 1, ArrowLeft: -1}[event.key];
      if (!move) return;
      const next = tabs[(index + move + tabs.length) % tabs.length];
      choose(next.name);
      next.button.focus();
    });
    list.append(tab.button);
  });
  return list;
}

function themeButton(redraw) {
  const button = h('button', {type: 'button', class: 'toggle'});
  const show = () => {
    document.documentElement.dataset.theme = state.theme;
    const other = state.theme === 'dark' ? 'light' : 'dark';
    button.textContent = state.theme === 'dark' ? '☀ Light' : '☾ Dark';
    button.setAttribute('aria-label', `Switch to ${other} colours`);
  };
  const change = (theme) => { state.theme = theme; show(); redraw(); };
  button.addEventListener('click', () => { state.themeChosen = true; change(state.theme === 'dark' ? 'light' : 'dark'); writeState(); });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => { if (!state.themeChosen) change(event.matches ? 'dark' : 'light'); });
  show();
  return button;
}

function redrawWhenWidthChanges(redraw) {
  let width = window.innerWidth;
  window.addEventListener('resize', () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    redraw();
  });
}

const overviewNow = () => fetched('data/overview');

function runTabs(overview) {
  const run = new RunTab(overview, state, overview.operator ? token : null);
  const live = new LiveFlight(overview, state, writeState, overviewNow);
  return [
    {name: 'run', title: 'Run', element: run.element, opened: () => run.open(), closed: () => run.close()},
    {name: 'live', title: 'In the air', element: live.element, opened: () => live.open(), closed: () => live.close()},
  ];
}

function storedTabs(overview) {
  const replay = new Replay(overview, state, writeState);
  const results = new Results(overview, state);
  const open = async () => {
    if (overview.run !== null) Object.assign(overview, await overviewNow());  // more has been flown
    return replay.open();
  };
  return [
    {name: 'flight', title: 'Flights', element: replay.element, opened: () => (replay.flight ? replay.draw() : open()), closed: () => { replay.pause(); if (overview.run !== null) replay.flight = null; }},
    {name: 'results', title: 'Results', element: results.element, opened: () => results.open(), closed: () => results.close()},
  ];
}

async function start() {
  const overview = await overviewNow();
  tabs = overview.run === null ? [] : runTabs(overview);
  if (overview.stored !== null) tabs.push(...storedTabs(overview));
  const redraw = () => tabs.find((tab) => tab.name === state.tab)?.opened();
  document.title = `${overview.title} – Aloft`;
  main.replaceChildren(
    h('header', {}, h('div', {class: 'bar'}, h('h1', {}, overview.title), themeButton(redraw)),
      h('p', {class: 'soft'}, overview.description), tabList()),
    ...tabs.map((tab) => tab.element),
    h('footer', {}, h('p', {}, overview.source)));
  redrawWhenWidthChanges(redraw);
  await choose(state.tab);
  window.addEventListener('hashchange', () => location.reload());
  document.body.setAttribute('data-ready', '');
}

window.addEventListener('error', (event) => { document.body.dataset.error = event.message; });
window.addEventListener('unhandledrejection', (event) => { document.body.dataset.error = String(event.reason); });
start().catch((error) => {
  document.body.dataset.error = error.message;
  main.replaceChildren(h('section', {}, h('h1', {}, 'This page cannot be shown'), h('p', {role: 'alert'}, error.message)));
});
