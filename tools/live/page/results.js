// The gains so far, per condition.

import {h, table} from '../../report/page/dom.js';
import {interval, number, signed, signedInterval} from '../../report/page/format.js';
import {marked, marksExplained, shapeOf} from '../../report/page/privilege.js';

/** The tab "Results": of a run that goes on, as flights arrive. */
export class Results {
  constructor(overview, state) {
    this.overview = overview;
    this.state = state;
    this.element = h('section', {id: 'results', 'aria-label': 'Results'}, h('p', {class: 'soft'}, 'No flight is stored yet.'));
  }

  open() {
    if (this.results) this.#show(this.results);
    if (this.source) return;
    return new Promise((resolve) => {
      this.source = new EventSource('events/results');
      this.source.onmessage = (event) => {
        this.#show(JSON.parse(event.data));
        if (this.overview.run === null) this.close();  // nothing is added
        resolve();
      };
      this.source.onerror = () => resolve();
    });
  }

  close() {
    this.source?.close();
    this.source = null;
  }

  #show(results) {
    this.results = results;
    const {overview, state: {theme}} = this;
    const agent = (row) => {
      const shape = h('span', {class: `swatch ${shapeOf(overview, row.name)}`});
      shape.style.color = overview.agents.find((other) => other.name === row.name)?.colour[theme] ?? '';
      return h('span', {class: 'agent'}, shape, marked(overview, row.name));
    };
    const value = (title, text) => ({title, number: true, text});
    const tables = results.conditions.map((condition, index) => {
      const {label, qos_name, qos_unit} = overview.conditions[index];
      if (!condition) return h('p', {class: 'soft'}, `${label}: no flight is stored yet.`);
      return table([
        {title: 'Agent', header: true, text: agent},
        value('Trials', (row) => String(row.trials)),
        value(`${qos_name} (${qos_unit})`, (row) => number(row.mean, 3)),
        value('95 % interval', (row) => interval(row.ci95, 3)),
        value('Gain over min-height', (row) => (row.gain ? signed(row.gain.mean, 3) : '–')),
        value('95 % interval of the gain', (row) => (row.gain ? signedInterval(row.gain.ci95, 3) : '–')),
      ], condition.agents, `${label}: ${condition.agents.reduce((sum, row) => sum + row.trials, 0)} flights`);
    });
    const explained = marksExplained(overview);
    this.element.replaceChildren(...[
      h('h2', {}, `Results of ${results.flights_stored} of ${results.flights_expected} flights`),
      explained ? h('p', {class: 'soft'}, explained) : null, ...tables].filter(Boolean));
  }
}
