// The report in a real browser: runs a small experiment, writes its report, looks at every chart.
// Usage: node page_test.mjs ALOFT_PROGRAM SOURCE_FOLDER NODE_MODULES [SCREENSHOT_FOLDER]

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {agents, aloft, fly, modules, pictures, scratch, sources, succeed} from './aloft.mjs';
import {Browser, findBrowser} from './browser.mjs';

const program = findBrowser();
if (!program) {
  console.log('SKIPPED: the report in a browser: there is no Chromium on the PATH; install the package chromium');
  process.exit(77);
}

const generated = join(scratch, 'generated');
const measured = join(scratch, 'measured');
const many = join(scratch, 'crowd', 'many');
const axe = readFileSync(join(modules, 'axe-core', 'axe.min.js'), 'utf8');

/** 22 agents of all tiers in 13 conditions, two short flights each. */
const crowd = {
  name: 'many', seed: 7, trials: 2,
  worlds: [
    {kind: 'generated', steps: 15, bs_density_per_km2: [1, 2.5, 5], building_density_per_km2: [100, 200, 300]},
    {kind: 'generated', steps: 15, bs_density_per_km2: 2.5, building_density_per_km2: 200, site_map_error_m: [10, 25, 50, 100]},
  ],
  agents: [...agents, 'present-column', 'next-column', 'site-planner', 'local-bandit', 'height-filter', 'pretrained', {type: 'planner', name: 'planner-smoothed', smoothing_m: 5},
    {type: 'constant', height_m: [60, 80, 90, 100, 150, 180, 200, 240]}],
};

function dataOf(page) {
  const html = readFileSync(page, 'utf8');
  const mark = 'id="report-data">';
  const from = html.indexOf(mark) + mark.length;
  return JSON.parse(html.slice(from, html.indexOf('</script>', from)));
}

/** Starts far more flights than can be flown in a moment, and interrupts them. */
async function interruptedRun(folder) {
  const flying = spawn(aloft, ['run', 'data/experiments/bs-density.json', '--out', folder, '--in-process', '--trials', '5000', '--agents', 'min-height,dqn'], {cwd: sources, stdio: 'ignore'});
  const ended = new Promise((resolve) => { flying.on('exit', resolve); });
  await new Promise((resolve) => { setTimeout(resolve, 4000); });
  flying.kill('SIGINT');
  assert.equal(await ended, 130);
}

/** Counts, in the page, what each chart has drawn: shapes inside marks, not axes or legends. */
const countMarks = `Object.fromEntries([...document.querySelectorAll('[data-chart]')].map((chart) => [chart.dataset.chart,
  [...chart.querySelectorAll('g.role-mark')].flatMap((group) => [...group.children])
    .filter((shape) => shape.tagName === 'line' || shape.tagName === 'text' || (shape.tagName === 'path' && shape.getAttribute('d'))).length]))`;

/** How many marks a chart must have at least, from the data it shows. */
function leastMarks(name, data, condition, view) {
  const count = condition.views[view]?.agents.length;
  const known = (interval) => condition.views[view].agents.filter((agent) => agent.name !== 'min-height' && interval(agent)).length;
  const flight = condition.flight;
  if (name.includes('-swept-')) return data.agents.length - 1;
  if (name.endsWith('-mean-height')) return data.agents.length;
  if (name.endsWith('-qos')) return condition.views[view].agents.reduce((sum, agent) => sum + (agent.trials > 1 ? 4 : 1), 0);
  if (name.endsWith('-gain')) return count - 1 + known((agent) => agent.gain.ci95);
  if (name.endsWith('-profile')) return count;
  if (name.endsWith('-energy')) return 2 * count + known((agent) => agent.ci95);
  if (name.endsWith('-heights')) return condition.views[view].agents.reduce((sum, agent) => sum + agent.heights.height_m.length, 0);
  if (name.endsWith('-gains')) return 2 * (data.agents.length - 1);
  if (name.endsWith('-over-steps')) return flight.agents.length;
  if (name.endsWith('-heat-map')) return flight.step.length * flight.map.height_m.length;
  if (name.endsWith('-city')) return 2 * flight.step.length;
  if (name.endsWith('-q-values')) return 3;
  return 1;
}

async function checkPage(browser, page, {options, address = '', view = 'all'} = {}) {
  const url = `file://${page}`;
  await browser.open(url + address, options);
  const data = dataOf(page);
  assert.equal(await browser.evaluate('document.body.dataset.error ?? ""'), '');
  assert.deepEqual(browser.complaints, []);
  assert.deepEqual(browser.requests.filter((request) => !/^(data|blob|about):/.test(request)).map((request) => request.split('#')[0]), [url], 'the page asks the network for something');
  const marks = await browser.evaluate(countMarks);
  const names = Object.keys(marks);
  assert.ok(names.length > 0);
  for (const name of names) {
    const condition = data.conditions.filter((other) => name.includes(other.name.toLowerCase().replace(/[^a-z0-9.]+/g, '-'))).at(-1) ?? data.conditions[0];
    const least = leastMarks(name, data, condition, view);
    assert.ok(marks[name] >= least, `${name}: ${marks[name]} marks, at least ${least} are in the data`);
  }
  const overflow = await browser.evaluate('document.documentElement.scrollWidth - document.documentElement.clientWidth');
  assert.equal(overflow, 0, 'the page scrolls sideways');
  assert.deepEqual(await browser.evaluate(unreadable), []);
  assert.deepEqual(await browser.evaluate(untold(data)), []);
  return {data, names};
}

/** In the page: pairs of texts of one chart that lie on each other, and charts that are drawn smaller than they were laid out. */
const unreadable = `[...document.querySelectorAll('[data-chart]')].flatMap((chart) => {
  const svg = chart.querySelector('svg.marks');
  const texts = [...svg.querySelectorAll('text')].filter((text) => text.textContent.trim() !== '' && text.getAttribute('opacity') !== '0').map((text) => ({text: text.textContent, box: text.getBoundingClientRect()}));
  const same = (a, b) => a.text === b.text && Math.abs(a.box.x - b.box.x) < 1 && Math.abs(a.box.y - b.box.y) < 1;  // a text and its halo
  const meet = (a, b) => Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left) > 1 && Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top) > 3;  // boxes are higher than letters
  const pairs = texts.flatMap((a, i) => texts.slice(0, i).filter((b) => meet(a, b) && !same(a, b)).map((b) => chart.dataset.chart + ': ' + a.text + ' on ' + b.text));
  const scale = svg.getBoundingClientRect().width / svg.getAttribute('width');
  return scale < 0.97 ? [...pairs, chart.dataset.chart + ': drawn at ' + scale] : pairs;
})`;

/** In the page: names of privileged agents without their mark, and charts with marks that do not say what these mean. */
const untold = (data) => `(() => {
  const tiers = ${JSON.stringify(data.privilege_tiers.filter((tier) => tier.mark !== ''))};
  const names = ${JSON.stringify(Object.fromEntries(data.agents.map((agent) => [agent.name, agent.privilege])))};
  const tierOf = (name) => tiers.find((tier) => tier.name === names[name]);
  return [...document.querySelectorAll('[data-chart], #results table, #published table')].flatMap((part) => {
    const chart = part.dataset.chart;
    const texts = chart ? [...part.querySelectorAll('text')].map((text) => text.textContent) : [...part.querySelectorAll('.agent')].map((text) => text.textContent);
    const tips = chart ? [...part.querySelectorAll('[aria-label]')].flatMap((mark) => [...mark.getAttribute('aria-label').matchAll(/Agent: ([^;]*)/g)].map(([, name]) => name)) : [];
    const bare = [...texts, ...tips].filter((text) => tierOf(text));
    const mute = chart ? tiers.filter((tier) => texts.some((text) => text.endsWith(' ' + tier.mark)) && !texts.some((text) => text.includes(tier.sees))).map((tier) => tier.mark) : [];
    return [...bare, ...mute].map((what) => (chart ?? 'table') + ': ' + what);
  });
})()`;

/** What axe-core finds that keeps people out. */
async function barriers(browser) {
  await browser.evaluate(axe);
  return browser.evaluate(`axe.run(document, {resultTypes: ['violations']}).then((found) => found.violations.filter((one) => ['serious', 'critical'].includes(one.impact)).map((one) => one.id + ': ' + one.nodes[0].html))`);
}

async function picture(browser, name) {
  if (!pictures) return;
  mkdirSync(pictures, {recursive: true});
  writeFileSync(join(pictures, `${name}.png`), await browser.screenshot());
}

describe('the report in a browser', () => {
  let browser;
  before(() => {
    fly('bs-density', generated);
    fly('measured', measured);
    browser = new Browser(program);
  });
  after(() => browser.close());

  test('generated cities: every chart, light and wide', async () => {
    succeed('report', generated);
    const {data, names} = await checkPage(browser, join(generated, 'report.html'));
    for (const ending of ['-qos', '-gain', '-profile', '-energy', '-heights', '-mean-height', '-height-over-steps', '-qos-over-steps', '-heat-map', '-city', '-epsilon', '-loss', '-q-values'])
      assert.ok(names.some((name) => name.endsWith(ending)), `no chart ${ending}`);
    assert.equal(names.filter((name) => name.endsWith('-qos')).length, data.conditions.length);
    assert.deepEqual(data.missing, []);
    const planner = data.conditions[1].views.all.agents.find((agent) => agent.name === 'planner');
    const points = await browser.evaluate(`[...document.querySelectorAll('[data-chart$=-gain-swept-bs-density-per-km2] path[aria-label]')].map((point) => point.getAttribute('aria-label'))`);
    assert.ok(points.some((label) => label.includes(`Agent: planner **; Base stations per km²: 2.5; Mean gain: ${planner.gain.mean < 0 ? '−' : '+'}${Math.abs(planner.gain.mean).toFixed(2)}`)), points.join());
    assert.deepEqual(await barriers(browser), []);
    await picture(browser, 'generated-light');
  });

  test('generated cities: dark, on a phone, another condition, selected trials', async () => {
    const page = join(generated, 'report.html');
    const canSelect = dataOf(page).conditions.some((condition) => condition.views.selected);
    await checkPage(browser, page, {options: {width: 390, scheme: 'dark'}, address: '#condition=1'});
    assert.equal(await browser.evaluate('document.documentElement.dataset.theme'), 'dark');
    await picture(browser, 'generated-phone-dark');
    if (!canSelect) return;
    await checkPage(browser, page, {address: '#trials=selected', view: 'selected'});
    assert.match(await browser.evaluate('document.getElementById("selection").textContent'), /Selected trials only/);
  });

  test('the reader can switch colours, condition and agent', async () => {
    await browser.open(`file://${join(generated, 'report.html')}`);
    const click = async (action) => { await browser.evaluate(action); await browser.ready(); };
    await click('document.querySelector("button.toggle").click()');
    assert.equal(await browser.evaluate('document.documentElement.dataset.theme'), 'dark');
    const select = (label, value) => click(`(() => { const box = [...document.querySelectorAll('label.choice')].find((one) => one.textContent.startsWith('${label}')).querySelector('select'); box.value = '${value}'; box.dispatchEvent(new Event('change')); })()`);
    await select('Condition', '2');
    await select('Agent', 'planner');
    assert.match(await browser.evaluate('document.querySelector("[data-chart$=-city]").parentElement.textContent'), /served planner/);
    assert.deepEqual(await browser.evaluate('Object.fromEntries(new URLSearchParams(location.hash.slice(1)))'), {theme: 'dark', condition: '2', agent: 'planner'});
    assert.deepEqual(browser.complaints, []);
  });

  test('a measured flight: throughput in Mbit/s, no city', async () => {
    succeed('report', measured);
    const {names} = await checkPage(browser, join(measured, 'report.html'));
    assert.ok(names.some((name) => name.endsWith('-heat-map')));
    assert.ok(!names.some((name) => name.endsWith('-city')));
    assert.match(await browser.evaluate('document.body.textContent'), /Throughput \(Mbit\/s\)/);
    await picture(browser, 'measured-light');
  });

  test('agents that see the future are hollow, and all privileged ones marked, in every chart that has them', async () => {
    await browser.open(`file://${join(generated, 'report.html')}`);
    const fills = await browser.evaluate(`Object.fromEntries([...document.querySelectorAll('[data-chart$=-qos], [data-chart$=-gain], [data-chart$=-energy]')].map((chart) =>
      [chart.dataset.chart, [...chart.querySelectorAll('g.role-mark path')].filter((shape) => shape.getAttribute('fill') === '#ffffff' && shape.getAttribute('stroke') !== '#1b2330').length]))`);
    for (const [name, hollow] of Object.entries(fills)) assert.ok(hollow >= 3, `${name}: ${hollow} hollow shapes for three agents`);
    const unmarked = await browser.evaluate(`[...document.querySelectorAll('[data-chart]')].filter((chart) => [...chart.querySelectorAll('text')].some((text) => ['planner', 'one-step-ahead', 'optimal-height', 'site-planner'].includes(text.textContent))).map((chart) => chart.dataset.chart)`);
    assert.deepEqual(unmarked, []);
    assert.match(await browser.evaluate('document.getElementById("results").textContent'), /planner \*\*.*/);
    assert.match(await browser.evaluate('document.getElementById("results").textContent'), /\* sees the next step at every height, \*\* sees the whole route at every height/);
  });

  test('22 agents in 13 conditions: everything can be read, on a desk and on a phone', async () => {
    const experiment = join(scratch, 'many.json');
    writeFileSync(experiment, JSON.stringify(crowd));
    succeed('run', experiment, '--out', many, '--in-process');
    succeed('report', many);
    const page = join(many, 'report.html');
    const {data, names} = await checkPage(browser, page);
    assert.deepEqual([data.agents.length, data.conditions.length], [22, 13]);
    assert.equal(names.filter((name) => name.endsWith('-energy')).length, 13);
    const widths = await browser.evaluate(`[...document.querySelectorAll('[data-chart$=-gains], [data-chart$=-mean-height], [data-chart$=-over-steps], [data-chart$=-heat-map]')].map((chart) => chart.clientWidth / document.documentElement.clientWidth)`);
    for (const width of widths) assert.ok(width > 0.9, `a chart takes ${width} of the page`);
    const knows = await browser.evaluate(`Object.fromEntries([...[...document.querySelectorAll('#results table')].at(-1).querySelectorAll('tbody tr')].map((row) => [row.children[0].textContent, row.children[1].textContent]))`);
    assert.equal(knows['planner **'], 'foresight');
    assert.equal(knows['site-planner +'], 'site map');
    assert.equal(knows.dqn, 'own reports');
    assert.deepEqual(names.filter((name) => name.includes('-gain-swept-')), ['many-gain-swept-bs-density-per-km2', 'many-gain-swept-building-density-per-km2', 'many-gain-swept-site-map-error-m']);
    await picture(browser, 'many-light');
    await checkPage(browser, page, {options: {width: 400, scheme: 'dark'}});
    await picture(browser, 'many-phone-dark');
    const table = await browser.evaluate(`(() => {
      const one = document.querySelector('#results .table');
      const scroll = one.querySelector('.scroll');
      const first = scroll.querySelector('tbody th');
      const before = first.getBoundingClientRect().left;
      scroll.scrollLeft = 300;
      return {hint: getComputedStyle(one.querySelector('.hint')).visibility, scrolled: scroll.scrollLeft, moved: first.getBoundingClientRect().left - before, wide: first.clientWidth / scroll.clientWidth};
    })()`);
    assert.deepEqual([table.hint, table.scrolled], ['visible', 300]);
    assert.ok(Math.abs(table.moved) < 1 && table.wide < 0.6, JSON.stringify(table));
  });

  test('two swept parameters: a cell for each agent and pair of values', async () => {
    const {data} = await checkPage(browser, join(many, 'report.html'), {address: '#conditions=0,1,2,3,4,5,6,7,8', options: {width: 400}});
    const cells = await browser.evaluate(`Object.fromEntries([...document.querySelectorAll('[data-chart$=-gain-swept-bs-density-per-km2-building-density-per-km2] .mark-text text[aria-label]')].map((text) => [text.getAttribute('aria-label'), text.textContent]))`);
    assert.equal(Object.keys(cells).length, 9 * 21, Object.keys(cells).slice(0, 3).join());
    const gain = data.conditions[5].views.all.agents.find((agent) => agent.name === 'dqn').gain.mean;
    const [, shown] = Object.entries(cells).find(([label]) => label.includes('across: 2.5; up: 300;') && label.includes('Agent: dqn;'));
    assert.equal(Number(shown.replace('−', '-')).toFixed(1), gain.toFixed(1).replace('-0.0', '0.0'));
    await picture(browser, 'many-cells-phone');
  });

  test('agents and conditions are chosen with the keyboard, and the address keeps the choice', async () => {
    await browser.open(`file://${join(many, 'report.html')}#agents=min-height,dqn,planner,site-planner&conditions=0,10`, {width: 400});
    const shown = () => browser.evaluate(`({status: document.getElementById('status').textContent, focus: document.activeElement.id,
      tables: [...document.querySelectorAll('#results table')].map((table) => table.querySelectorAll('tbody tr').length), address: location.hash,
      lines: new Set([...document.querySelectorAll('#flight [data-chart$=-height-over-steps] .role-mark path')].map((path) => path.getAttribute('stroke'))).size})`);
    assert.deepEqual(await shown(), {status: 'Shown: 4 of 22 agents in 2 of 13 conditions', focus: '', tables: [4, 4], address: '#agents=min-height,dqn,planner,site-planner&conditions=0,10', lines: 4});
    await browser.evaluate(`document.getElementById('agents-summary').focus()`);
    for (const key of ['Enter', 'Tab', 'Tab', 'Tab', ' ']) await browser.press(key);  // unfold, past All and None, the first box: min-height
    await browser.ready();
    assert.deepEqual(await shown(), {status: 'Shown: 3 of 22 agents in 2 of 13 conditions', focus: 'agents-0', tables: [3, 3], address: '#agents=planner%2Csite-planner%2Cdqn&conditions=0%2C10', lines: 3});
    await browser.evaluate(`document.getElementById('conditions-shown').open = true`);
    assert.deepEqual(await barriers(browser), []);
    await picture(browser, 'filter-phone-light');
    await browser.evaluate(`document.getElementById('agents-none').click()`);
    await browser.ready();
    assert.match(await browser.evaluate('document.getElementById("results").textContent'), /Nothing is chosen: tick agents and conditions/);
    await browser.evaluate(`document.getElementById('agents-all').click()`);
    await browser.ready();
    assert.equal((await shown()).status, 'Shown: 22 of 22 agents in 2 of 13 conditions');
    assert.deepEqual(browser.complaints, []);
  });

  test('one trial: no interval, no box, nothing that is not a number', async () => {
    const single = join(scratch, 'single', 'run');
    succeed('run', 'data/experiments/bs-density.json', '--out', single, '--in-process', '--trials', '1', '--agents', 'min-height,random-walk,planner');
    succeed('report', single);
    await browser.open(`file://${join(single, 'report.html')}`);
    assert.equal(await browser.evaluate('document.body.dataset.error ?? ""'), '');
    assert.deepEqual(browser.complaints, []);
    const tables = await browser.evaluate('[...document.querySelectorAll("#results table")].map((table) => table.textContent).join(" ")');
    assert.match(tables, /planner \*\*/);
    assert.doesNotMatch(tables, /…|NaN|null|±/);
    const bars = await browser.evaluate(`[...document.querySelectorAll('[data-chart$=-qos] g.mark-rect.role-mark path, [data-chart$=-qos] g.mark-rule.role-mark line, [data-chart$=-energy] g.mark-rule.role-mark line[x2="0"]')].length`);
    assert.equal(bars, 0);
  });

  test('several runs in one page', async () => {
    succeed('report', scratch);
    const {data} = await checkPage(browser, join(scratch, 'report.html'));
    assert.deepEqual(data.experiments.map((experiment) => experiment.flights_stored), [72, 21]);
  });

  test('an interrupted run says what is missing and shows the rest', async () => {
    const folder = join(scratch, 'unfinished');
    await interruptedRun(folder);
    succeed('report', folder);
    const {data} = await checkPage(browser, join(folder, 'report.html'));
    assert.ok(data.missing.length > 0);
    const shown = await browser.evaluate('document.getElementById("missing").textContent');
    for (const line of data.missing) assert.ok(shown.includes(line));
  });
});
