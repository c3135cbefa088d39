// Orders of the operator: which agent flies the relays of a worker from now on.

import {choice, h} from '../../report/page/dom.js';

const key = 'aloft-token';

/** The token of the printed address, which leaves the address bar: a link that is shared must not hand it on. */
export function takeToken(given) {
  if (given) sessionStorage.setItem(key, given);
  return sessionStorage.getItem(key);
}

/** A form under the workers. */
export class Swap {
  #shown = '';

  constructor(token) {
    this.token = token;
    this.controls = h('div', {class: 'bar controls'});
    this.outcome = h('p', {role: 'status'});
    this.dialog = h('dialog', {'aria-labelledby': 'swap-question'});
    this.element = h('div', {id: 'swap', hidden: true}, h('h2', {}, 'Swap'), this.controls, this.outcome, this.dialog);
  }

  /** `workers` as aloft status tells them. */
  show(workers) {
    this.workers = workers.filter((worker) => worker.state === 'alive' && worker.agents.length > 0);
    this.element.hidden = this.workers.length === 0;
    const list = JSON.stringify(this.workers.map(({worker, agents}) => [worker, agents.map(({agent}) => agent)]));
    if (list === this.#shown || this.dialog.open) return;
    this.#shown = list;
    this.#fill();
  }

  #fill() {
    if (this.workers.length === 0) return;
    const worker = this.workers.find((one) => one.worker === this.worker) ?? this.workers[0];
    this.worker = worker.worker;
    if (!worker.agents.some(({agent}) => agent === this.agent)) this.agent = worker.agents[0].agent;
    this.controls.replaceChildren(
      choice('Swap on worker', this.workers.map((one) => ({value: one.worker, text: one.worker})), this.worker, (name) => { this.worker = name; this.#fill(); }),
      choice('Let fly', worker.agents.map(({agent}) => ({value: agent, text: agent})), this.agent, (name) => { this.agent = name; }),
      h('button', {type: 'button', onclick: () => this.#ask()}, 'Swap …'));
  }

  #ask() {
    const worker = this.workers.find((one) => one.worker === this.worker);
    this.dialog.replaceChildren(
      h('h2', {id: 'swap-question'}, `Let ${this.agent} fly on worker ${this.worker}?`),
      h('p', {}, `From the next step on, ${this.agent} flies the relays of worker ${this.worker} (host ${worker.host}) that have it in their crew: those in the air (${worker.leases.length} trials now) and those that start later.`),
      h('p', {}, 'The results name who flew each step. Other workers and agents that fly alone go on as they are. The order cannot be taken back; another one can be given.'),
      h('div', {class: 'bar controls'},
        h('button', {type: 'button', onclick: () => { this.dialog.close(); this.#order(); }}, `Let ${this.agent} fly`),
        h('button', {type: 'button', onclick: () => this.dialog.close()}, 'Cancel')));
    this.dialog.showModal();
  }

  async #order() {
    this.outcome.className = '';
    this.outcome.textContent = `Worker ${this.worker} is told …`;
    try {
      const answer = await fetch(`swap?worker=${encodeURIComponent(this.worker)}&agent=${encodeURIComponent(this.agent)}`, {method: 'POST', headers: {Authorization: `Bearer ${this.token}`}});
      const text = await answer.text();
      if (!answer.ok) throw new Error(text);
      this.outcome.textContent = JSON.parse(text).outcome;
    } catch (error) {
      this.outcome.className = 'bad';
      this.outcome.textContent = error.message;
    }
  }
}
