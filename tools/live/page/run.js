// A run as it goes: progress, rates over time, workers and what is wrong.

import {h, table} from '../../report/page/dom.js';
import {number} from '../../report/page/format.js';
import {surfaces} from '../../report/page/theme.js';
import {extent, plot} from './plot.js';
import {Swap} from './swap.js';

const kept = 1200;  // events of the charts: ten minutes

function clock(seconds) {
  if (!Number.isFinite(seconds)) return '–';
  const parts = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, Math.floor(seconds % 60)];
  return (parts[0] > 0 ? parts : parts.slice(1)).map((part, i) => (i > 0 ? String(part).padStart(2, '0') : part)).join(':');
}

/** The tab "Run". It listens only while it is shown. */
export class RunTab {
  /** `token`: null if this page cannot give orders. */
  constructor(overview, state, token) {
    this.overview = overview;
    this.state = state;
    this.swap = token ? new Swap(token) : null;
    this.history = [];
    this.charts = [['Flights per second', 'flights_per_s'], ['Steps per second', 'steps_per_s'], ['99 % of the answers within (ms), slowest worker', 'answer_p99_ms'], ['Flights that are not stored yet', 'unstored'], ['Drops', 'drops'], ['Workers alive', 'workers']]
      .map(([title, field]) => ({title, field, canvas: h('canvas', {role: 'img', 'aria-label': `${title} over the last minutes`})}));
    this.connection = h('p', {class: 'bad', role: 'alert'});
    this.news = h('div', {});
    this.element = h('section', {id: 'run', 'aria-label': 'Run'}, this.connection, this.news, this.swap?.element,
      h('div', {class: 'stage'}, this.charts.map((chart) => h('figure', {}, h('figcaption', {}, chart.title), chart.canvas))));
  }

  open() {
    if (this.source) return this.#draw();
    return new Promise((resolve) => {
      this.source = new EventSource('events/run');
      this.source.onmessage = (event) => {
        this.connection.textContent = '';
        this.#hear(JSON.parse(event.data));
        resolve();
      };
      this.source.onerror = () => {
        const stored = this.overview.stored ? ` To see the stored flights: aloft live ${this.overview.stored}` : '';
        this.connection.textContent = `aloft live does not answer; what follows is the last that was heard.${stored}`;
        resolve();
      };
    });
  }

  close() {
    this.source?.close();
    this.source = null;
  }

  #hear(run) {
    this.run = run;
    const alive = run.workers.filter((worker) => worker.state === 'alive');
    const sum = (field) => run.workers.reduce((total, worker) => total + worker[field], 0);
    this.history.push({
      time: performance.now() / 1000, flights_per_s: run.flights_per_s, steps_per_s: run.steps_per_s, workers: alive.length,
      answer_p99_ms: alive.reduce((slowest, worker) => Math.max(slowest ?? 0, worker.answer_p99_ms), null), unstored: sum('records_unconfirmed'), drops: sum('drops'),
    });
    if (this.history.length > kept) this.history.shift();
    this.#draw();
  }

  #draw() {
    const {run} = this;
    if (!run) return;
    const fact = (title, text, kind) => h('div', {}, h('dt', {}, title), h('dd', {class: kind}, text));
    const silent = run.state === 'unknown';
    this.news.replaceChildren(
      h('h2', {}, `Run ${run.run}${run.experiment ? `, experiment ${run.experiment}` : ''}`),
      h('progress', {max: run.flights_total || 1, value: run.flights_stored, 'aria-label': 'Flights stored'}),
      h('dl', {class: 'facts'},
        fact('State', silent ? 'nobody answers yet' : run.state, silent || run.state === 'failed' ? 'bad' : null),
        fact('Flights stored', `${run.flights_stored} of ${run.flights_total}`),
        fact('Flights/s', number(run.flights_per_s, 1)),
        fact('Steps/s', number(run.steps_per_s, 0)),
        fact('Time left', clock(run.eta_s ?? NaN)),
        fact('Trials done / leased / pending / failed', ['done', 'leased', 'pending', 'failed'].map((state) => run.trials[state]).join(' / ')),
        fact('Collector', run.collector.state, ['storing', 'unknown'].includes(run.collector.state) ? null : 'bad'),
        fact('Middleware', run.middleware.join(', ') || '–')),
      ...this.#problems(), ...this.#workers());
    this.swap?.show(run.workers);
    this.#plot();
  }

  #problems() {
    const {run} = this;
    const lines = [];
    if (run.message) lines.push(run.message);
    if (run.collector.message) lines.push(`collector: ${run.collector.message}`);
    for (const worker of run.workers) {
      if (worker.state === 'lost') lines.push(`worker ${worker.worker} on ${worker.host} is lost: silent for ${clock(worker.silent_s)}`);
      if (worker.missing) lines.push(`worker ${worker.worker} waits for ${worker.missing}`);
      for (const agent of worker.agents) if (agent.state === 'lost') lines.push(`worker ${worker.worker}: agent ${agent.agent} (${agent.process}) is lost`);
      for (const failure of worker.failures) lines.push(`worker ${worker.worker}: lease ${failure.lease} failed: ${failure.reason}`);
    }
    return lines.length > 0 ? [h('div', {class: 'notice', role: 'status'}, h('ul', {}, lines.map((line) => h('li', {}, line))))] : [];
  }

  #workers() {
    const value = (title, text) => ({title, number: true, text});
    if (this.run.workers.length === 0) return [h('p', {class: 'soft'}, 'No worker has been heard yet.')];
    return [table([
      {title: 'Worker', header: true, text: (worker) => worker.worker},
      {title: 'Host', text: (worker) => worker.host},
      {title: 'State', text: (worker) => h('span', {class: worker.state === 'lost' ? 'bad' : worker.state === 'alive' ? 'good' : null}, worker.state)},
      value('Leases', (worker) => `${worker.leases.length} of ${worker.capacity}`),
      value('Flights', (worker) => String(worker.flights_done)),
      value('Flights/s', (worker) => number(worker.flights_per_s, 1)),
      value('Steps/s', (worker) => number(worker.steps_per_s, 0)),
      value('Half the answers within (ms)', (worker) => number(worker.answer_p50_ms, 1)),
      value('99 % within (ms)', (worker) => number(worker.answer_p99_ms, 1)),
      value('Unstored', (worker) => String(worker.records_unconfirmed)),
      value('Drops', (worker) => String(worker.drops)),
      {title: 'Agents', long: true, text: (worker) => worker.agents.map((agent) => `${agent.agent} ${agent.state}`).join(', ')},
    ], this.run.workers, 'Workers')];
  }

  #plot() {
    const surface = surfaces[this.state.theme];
    const now = this.history[this.history.length - 1].time;
    const x = this.history.map((point) => point.time - now);
    for (const {field, canvas} of this.charts) {
      const values = this.history.map((point) => point[field]);
      const range = extent([values, [0]]) ?? [0, 1];
      plot(canvas, {height: 170, surface, x, xRange: [Math.min(-30, x[0]), 0], yRange: [0, range[1] > 0.01 ? range[1] : 1], xTitle: 'Seconds', lines: [{values, colour: this.state.theme === 'dark' ? '#7db4f0' : '#0058a3', width: 2}]});
    }
  }
}
