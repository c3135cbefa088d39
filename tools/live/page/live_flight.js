// Flights in the air: subscribes to a worker while it is shown.

import {choice, h} from '../../report/page/dom.js';
import {marked} from '../../report/page/privilege.js';
import {FlightStage} from './flight_stage.js';
import {fetched} from './fetched.js';

/** The tab "In the air". `state`: what the address names; `changed()` writes it there; `overviewNow()` asks for the overview anew. */
export class LiveFlight {
  #open = false;
  #choices = '';
  #world = {};

  constructor(overview, state, changed, overviewNow) {
    Object.assign(this, {overview, state, changed, overviewNow, workers: []});
    this.stage = new FlightStage(overview);
    this.controls = h('div', {class: 'bar controls'});
    this.problem = h('p', {class: 'bad', role: 'alert'});
    this.note = h('p', {class: 'soft'}, 'Looking for a worker …');
    this.stage.element.hidden = true;
    this.element = h('section', {id: 'live', 'aria-label': 'In the air'}, this.controls, this.problem, this.note, this.stage.element);
    document.addEventListener('visibilitychange', () => this.#follow());
  }

  open() {
    this.#open = true;
    if (this.run) return this.#draw();
    this.run = new EventSource('events/run');
    this.run.onmessage = (event) => this.#hearRun(JSON.parse(event.data));
    this.run.onerror = () => { this.problem.textContent = 'aloft live does not answer; what follows is the last that was heard.'; };
    this.#follow();
  }

  close() {
    this.#open = false;
    this.run?.close();
    this.run = null;
    this.#follow();
  }

  #hearRun(run) {
    this.problem.textContent = '';
    this.workers = run.workers.filter((worker) => worker.state === 'alive' || worker.worker === this.state.worker).map((worker) => worker.worker);
    if (!this.state.worker && this.workers.length > 0) this.#choose({worker: this.workers[0], stream: null});
    this.#fillControls();
  }

  #choose(part) {
    Object.assign(this.state, part);
    this.changed();
    this.#follow();
  }

  /** Asks for what is chosen, and for nothing while nobody looks. */
  #follow() {
    const {worker, stream} = this.state;
    const wanted = this.#open && worker && !document.hidden ? `events/flight?worker=${encodeURIComponent(worker)}${stream === null ? '' : `&stream=${stream}`}` : null;
    if (wanted === this.asked) return;
    this.asked = wanted;
    this.source?.close();
    this.source = null;
    if (wanted === null) return;
    this.source = new EventSource(wanted);
    this.source.onmessage = (event) => { this.problem.textContent = ''; this.#hear(JSON.parse(event.data)); };
    this.source.addEventListener('failure', (event) => { this.problem.textContent = event.data; });
  }

  async #hear(view) {
    this.view = view;
    this.#fillControls();
    if (this.overview.agents.length === 0) Object.assign(this.overview, await this.overviewNow());
    if (view.flight) await this.#findWorld(view.flight);
    this.#draw();
  }

  /** The city, the route, and what agents with foresight see: once for each world. */
  async #findWorld({condition, trial}) {
    if (this.#world.condition === condition && this.#world.trial === trial) return;
    this.#world = {condition, trial};
    const world = this.#world;
    try {
      Object.assign(world, await fetched(`data/world?condition=${condition}&trial=${trial}`));
    } catch (error) {
      world.problem = error.message;
    }
  }

  #draw() {
    const flight = this.view?.flight;
    const condition = this.overview.conditions[flight?.condition];
    this.stage.element.hidden = !condition;
    if (!condition) {
      this.note.textContent = this.state.worker ? `Worker ${this.state.worker}: no flight has been heard yet.` : 'No worker has been heard yet.';
      return;
    }
    const world = this.#world;
    this.note.textContent = `${condition.label}, trial ${flight.trial}, ${flight.over ? 'flown; the next one follows' : 'in the air'}.${world.problem ? ` The city cannot be shown here: ${world.problem}` : ''}`;
    const order = this.overview.agents.map((agent) => agent.name);
    const agents = [...flight.agents].sort((a, b) => order.indexOf(a.name) - order.indexOf(b.name));
    const followed = agents.find((track) => track.stream === this.view.stream) ?? agents[0];
    if (!followed) return;
    const shown = {...flight, agents, city: world.city ?? null, route: world.route ?? null, map: world.map ? this.#columns(world.map, flight) : null};
    this.stage.set(shown, condition, followed.name, this.state.theme);
    this.stage.draw(Math.max(0, followed.at - flight.step[0]));
  }

  /** The part of the map whose steps are shown. */
  #columns(map, flight) {
    const [first] = flight.step;
    return {height_m: map.height_m, qos: map.qos.slice(first - 1, first - 1 + flight.step.length)};
  }

  #fillControls() {
    const streams = this.view?.streams ?? [];
    const key = JSON.stringify([this.workers, streams.map(({stream, agent}) => [stream, agent]), this.state.worker, this.view?.stream]);
    if (key === this.#choices) return;  // a list that is open stays open
    this.#choices = key;
    this.controls.replaceChildren(
      choice('Worker', this.workers.map((worker) => ({value: worker, text: worker})), this.state.worker, (worker) => { this.view = null; this.#choose({worker, stream: null}); }),
      choice('Stream', streams.map(({stream, agent}) => ({value: stream, text: `${stream}: ${marked(this.overview, agent)}`})), this.view?.stream, (stream) => this.#choose({stream: Number(stream)})));
  }
}
