// One world as all its agents fly it: the city, the quantities over the steps, and a table of the step that is shown.

import {h, table} from '../../report/page/dom.js';
import {number} from '../../report/page/format.js';
import {marked, shapeOf} from '../../report/page/privilege.js';
import {surfaces} from '../../report/page/theme.js';
import {drawCity} from './city.js';
import {extent, plot} from './plot.js';

const smoothed_steps = 10;

/** The mean of those that are known; null if none is. */
function mean(values) {
  const known = values.filter((value) => value !== null);
  return known.length > 0 ? known.reduce((sum, value) => sum + value, 0) / known.length : null;
}

/** The mean over the last ten steps, because fading makes single steps vary. */
function smoothed(values) {
  return values.map((value, i) => (value === null ? null : mean(values.slice(Math.max(0, i + 1 - smoothed_steps), i + 1))));
}

/** The range of all values but the highest fiftieth, so that single peaks do not wash out the rest. */
function bulk(columns) {
  const values = columns.flat().sort((a, b) => a - b);
  const high = values[Math.floor(0.98 * (values.length - 1))];
  return [values[0], high > values[0] ? high : values[0] + 1];
}

const learning = [
  {title: 'Q-values of the chosen agent: down (dotted), hold (dashed), up', fields: [['q_down', [2, 3]], ['q_hold', [6, 4]], ['q_up', []]]},
  {title: 'Exploration rate ε of the chosen agent', fields: [['epsilon', []]]},
  {title: 'Training loss of the chosen agent, log10', fields: [['loss', []]], log: true},
];

/**
 * Shows `flight` (see flight_view.hpp, and flight_log.hpp for flights in the air, where values can be missing and each agent is
 * at a step of its own). `overview` names and colours the agents, `condition` the quality.
 */
export class FlightStage {
  constructor(overview) {
    this.overview = overview;
    this.city = h('canvas', {role: 'img', 'aria-label': 'The city from above'});
    this.charts = h('div', {class: 'stage'});
    this.step = h('div', {});
    this.element = h('div', {},
      h('div', {class: 'stage'},
        h('figure', {}, h('figcaption', {}, 'City from above: base stations △, the one that serves filled'), this.city),
        h('div', {}, this.step)),
      this.charts);
  }

  /** Another flight, agent or theme. */
  set(flight, condition, agent, theme) {
    this.flight = flight;
    this.condition = condition;
    this.track = flight.agents.find((track) => track.name === agent) ?? flight.agents[0];
    this.surface = surfaces[theme];
    this.theme = theme;
    this.smooth = new Map(flight.agents.map((track) => [track.name, smoothed(track.qos)]));
    this.#addCharts();
  }

  #look(name) {
    return this.overview.agents.find((agent) => agent.name === name) ?? {colour: {light: '#444444', dark: '#d0d0d0'}, dash: [1, 0]};
  }

  #colour(name) {
    return this.#look(name).colour[this.theme];
  }

  /** A line per agent, the chosen one last and thickest. */
  #lines(valuesOf, steps) {
    const order = [...this.flight.agents].sort((a, b) => (a === this.track) - (b === this.track));
    return order.map((track) => ({values: valuesOf(track), colour: this.#colour(track.name), dash: this.#look(track.name).dash, width: track === this.track ? 3 : 1.3, steps}));
  }

  #addCharts() {
    const {flight, condition} = this;
    const quality = `${condition.qos_name} (${condition.qos_unit})`;
    const foreseeing = this.overview.agents.filter((agent) => shapeOf(this.overview, agent.name) === 'hollow').map((agent) => marked(this.overview, agent.name));
    const map = !flight.map ? '' : `; underneath: ${condition.qos_name} at every height, ${this.theme === 'dark' ? 'bright' : 'dark'} is better` + (foreseeing.length > 0 ? `; seen ahead by ${foreseeing.join(', ')} alone` : '; no agent here sees it ahead');
    this.drawings = [
      {title: `Height (m)${map}`, lines: this.#lines((track) => track.height_m, true), yRange: [flight.height_min_m, flight.height_max_m], under: this.#map(), height: 260},
      {title: `${quality}, mean of the last ${smoothed_steps} steps`, lines: this.#lines((track) => this.smooth.get(track.name))},
      {title: 'SINR of the serving base station (dB)', lines: this.#lines((track) => track.sinr_db)},
      {title: 'Reward of the step', lines: this.#lines((track) => track.reward)},
    ];
    if (this.track.learning) for (const chart of learning) {
      const values = (field) => (chart.log ? this.track.learning[field].map((value) => (value > 0 ? Math.log10(value) : null)) : this.track.learning[field]);
      this.drawings.push({title: chart.title, lines: chart.fields.map(([field, dash]) => ({values: values(field), colour: this.#colour(this.track.name), dash, width: 2}))});
    }
    this.#placeCharts();
  }

  /** Charts of the same titles stay where they are. */
  #placeCharts() {
    const titles = this.drawings.map((drawing) => drawing.title).join('\n');
    if (titles !== this.titles)
      this.charts.replaceChildren(...this.drawings.map(({title}) => h('figure', {}, h('figcaption', {}, title), h('canvas', {role: 'img', 'aria-label': title}))));
    this.titles = titles;
    [...this.charts.querySelectorAll('canvas')].forEach((canvas, i) => { this.drawings[i].canvas = canvas; });
  }

  /** The quality at every height as an image of one pixel per step and height. */
  #map() {
    const {map} = this.flight;
    if (!map) return undefined;
    const range = bulk(map.qos);
    const image = document.createElement('canvas');
    image.width = map.qos.length;
    image.height = map.height_m.length;
    const context = image.getContext('2d');
    const pixels = context.createImageData(image.width, image.height);
    map.qos.forEach((column, i) => column.forEach((qos, k) => {
      const share = Math.max(0, Math.min(1, (qos - range[0]) / (range[1] - range[0])));
      const at = 4 * ((image.height - 1 - k) * image.width + i);
      const level = this.theme === 'dark' ? 30 + 130 * share : 255 - 130 * share;
      pixels.data.set([level, level, level, 255], at);
    }));
    context.putImageData(pixels, 0, 0);
    const rise = map.height_m.length > 1 ? map.height_m[1] - map.height_m[0] : 1;
    const steps = this.flight.step;
    return (target, toX, toY) => {
      target.imageSmoothingEnabled = false;
      const top = toY(map.height_m[map.height_m.length - 1] + rise / 2);
      const left = toX(steps[0] - 0.5);
      target.drawImage(image, left, top, toX(steps[steps.length - 1] + 0.5) - left, toY(map.height_m[0] - rise / 2) - top);
    };
  }

  /** Draws the state after the step with index `at`. */
  draw(at) {
    const {flight, track, surface} = this;
    drawCity(this.city, {flight, track, at, surface, colour: this.#colour(track.name), dark: this.theme === 'dark'});
    const xRange = [flight.step[0] - 0.5, flight.step[flight.step.length - 1] + 0.5];
    for (const drawing of this.drawings) {
      const yRange = drawing.yRange ?? extent(drawing.lines.map((line) => line.values)) ?? [0, 1];
      plot(drawing.canvas, {height: drawing.height ?? 200, surface, x: flight.step, xRange, yRange, xTitle: 'Step', lines: drawing.lines, now: flight.step[at], under: drawing.under});
    }
    this.#fillTable(at);
  }

  #fillTable(at) {
    const {step} = this.flight;
    const inTheAir = this.track.at !== undefined;
    const place = (track) => (inTheAir ? Math.max(0, track.at - step[0]) : at);
    const swatch = (name) => {
      const shape = h('span', {class: `swatch ${shapeOf(this.overview, name)}`});
      shape.style.color = this.#colour(name);
      return h('span', {class: 'agent'}, shape, marked(this.overview, name));
    };
    const value = (title, text) => ({title, number: true, text});
    const filled = table([
      {title: 'Agent', header: true, text: (track) => swatch(track.name)},
      ...(inTheAir ? [value('Step', (track) => String(track.at))] : []),
      value('Height (m)', (track) => number(track.height_m[place(track)], 0)),
      value('Serving cell', (track) => ((track.serving_cell[place(track)] ?? -1) >= 0 ? String(track.serving_cell[place(track)]) : '–')),
      value('SINR (dB)', (track) => number(track.sinr_db[place(track)], 1)),
      value(`${this.condition.qos_name} (${this.condition.qos_unit})`, (track) => number(track.qos[place(track)])),
      value('Reward', (track) => number(track.reward[place(track)])),
      value('Mean so far', (track) => number(mean(track.qos.slice(0, place(track) + 1)), 3)),
    ], this.flight.agents, inTheAir ? `All agents in this world, of ${step[step.length - 1]} steps` : `Step ${step[at]} of ${step[step.length - 1]}`);
    [...filled.querySelectorAll('tbody tr')].forEach((row, i) => row.classList.toggle('chosen', this.flight.agents[i] === this.track));
    this.step.replaceChildren(filled);
  }
}
