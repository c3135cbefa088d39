// Stored flights: play, pause, speed, step; the address names what is shown.

import {choice, h} from '../../report/page/dom.js';
import {marked} from '../../report/page/privilege.js';
import {fetched} from './fetched.js';
import {FlightStage} from './flight_stage.js';

const steps_per_s = 10;
const speeds = [0.25, 0.5, 1, 2, 4, 8];

/** The tab "Flight" of a replay. `state`: what the address names; `changed(part)` writes it there. */
export class Replay {
  #playing = false;
  #at = 0;
  #frame = 0;

  constructor(overview, state, changed) {
    this.overview = overview;
    this.state = state;
    this.changed = changed;
    this.stage = new FlightStage(overview);
    this.controls = h('div', {class: 'bar controls'});
    this.play = h('button', {type: 'button', onclick: () => this.toggle()}, '▶ Play');
    this.slider = h('input', {type: 'range', min: 0, max: 0, value: 0, 'aria-label': 'Step', oninput: () => { this.pause(); this.show(Number(this.slider.value)); }});
    this.output = h('output', {});
    this.problem = h('p', {class: 'bad', role: 'alert'});
    const button = (text, label, act) => h('button', {type: 'button', 'aria-label': label, title: label, onclick: act}, text);
    this.element = h('section', {id: 'flight', 'aria-label': 'Flight'}, this.controls, this.problem,
      h('div', {class: 'transport', role: 'group', 'aria-label': 'Playback'},
        button('|◀', 'First step', () => { this.pause(); this.show(0); }),
        button('−1', 'One step back', () => { this.pause(); this.show(this.#at - 1); }),
        this.play,
        button('+1', 'One step on', () => { this.pause(); this.show(this.#at + 1); }),
        button('▶|', 'Last step', () => { this.pause(); this.show(Infinity); }),
        this.slider, this.output,
        choice('Speed', speeds.map((speed) => ({value: speed, text: `${speed * steps_per_s} steps/s`})), 1, (speed) => { this.speed = Number(speed); })),
      this.stage.element);
    this.speed = 1;
    document.addEventListener('keydown', (event) => this.#key(event));
  }

  #key(event) {
    if (!this.flight || this.element.hidden || event.target.closest('input, select, button, a, textarea, [role="region"]')) return;
    if (event.key === ' ') this.toggle();
    else if (event.key === 'ArrowRight') { this.pause(); this.show(this.#at + 1); }
    else if (event.key === 'ArrowLeft') { this.pause(); this.show(this.#at - 1); }
    else return;
    event.preventDefault();
  }

  /** Fetches the flight that the state names, and shows it. */
  async open() {
    this.pause();
    const {conditions} = this.overview;
    const condition = conditions[this.state.condition] ? this.state.condition : 0;
    const {trials} = conditions[condition];
    this.problem.textContent = '';
    if (trials.length === 0) {
      this.flight = null;
      this.problem.textContent = 'No flight of this condition is stored yet.';
      this.#fillControls(condition, null);
      return;
    }
    const trial = trials.includes(this.state.trial) ? this.state.trial : trials[0];
    try {
      this.flight = await fetched(`data/flight?condition=${condition}&trial=${trial}`);
    } catch (error) {
      this.problem.textContent = `This flight cannot be shown: ${error.message}`;
      return;
    }
    Object.assign(this.state, {condition, trial});
    if (!this.flight.agents.some((track) => track.name === this.state.agent)) this.state.agent = this.flight.agents[this.flight.agents.length - 1].name;
    this.#fillControls(condition, trial);
    this.slider.max = this.flight.step.length - 1;
    this.draw();
  }

  /** Draws anew, e.g. in another theme or width. */
  draw() {
    if (!this.flight) return;
    this.stage.set(this.flight, this.overview.conditions[this.state.condition], this.state.agent, this.state.theme);
    this.show(this.flight.step.indexOf(this.state.step));
  }

  #fillControls(condition, trial) {
    const {conditions} = this.overview;
    const {trials} = conditions[condition];
    const choose = (part) => { Object.assign(this.state, part); this.open(); };
    const number = h('input', {type: 'number', min: trials[0], max: trials[trials.length - 1], value: trial, onchange: () => choose({trial: Number(number.value), step: null})});
    this.controls.replaceChildren(...[
      choice('Condition', conditions.map((other, index) => ({value: index, text: other.label})), condition, (value) => choose({condition: Number(value), step: null})),
      trial === null ? null : h('label', {class: 'choice'}, h('span', {}, 'Trial'), number),
      trial === null ? null : choice('Agent', this.flight.agents.map((track) => ({value: track.name, text: marked(this.overview, track.name)})), this.state.agent, (agent) => { this.state.agent = agent; this.draw(); }),
    ].filter(Boolean));
  }

  /** Shows the step with this index, the nearest that there is. */
  show(index) {
    const last = this.flight.step.length - 1;
    this.#at = Math.max(0, Math.min(last, index));
    this.slider.value = this.#at;
    this.state.step = this.flight.step[this.#at];
    this.slider.setAttribute('aria-valuetext', `step ${this.state.step}`);
    this.output.textContent = `step ${this.state.step} of ${this.flight.step[last]}`;
    this.stage.draw(this.#at);
    if (!this.#playing) this.changed();
  }

  toggle() {
    if (this.#playing) this.pause(); else this.start();
  }

  start() {
    if (!this.flight) return;
    if (this.#at === this.flight.step.length - 1) this.show(0);
    this.#playing = true;
    this.play.textContent = '⏸ Pause';
    let shown = performance.now();
    const next = (now) => {
      if (!this.#playing) return;
      const steps = Math.floor((now - shown) / 1000 * steps_per_s * this.speed);
      if (steps > 0) {
        shown = now;
        this.show(this.#at + steps);
        if (this.#at === this.flight.step.length - 1) return this.pause();
      }
      this.#frame = requestAnimationFrame(next);
    };
    this.#frame = requestAnimationFrame(next);
  }

  pause() {
    if (!this.#playing) return;
    this.#playing = false;
    cancelAnimationFrame(this.#frame);
    this.play.textContent = '▶ Play';
    this.changed();
  }
}
