// The report in a real browser: runs a small experiment, writes its report, looks at every chart.
// Usage: node page_test.mjs ALOFT_PROGRAM SOURCE_FOLDER [SCREENSHOT_FOLDER]

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {aloft, fly, pictures, scratch, sources, succeed} from './aloft.mjs';
import {Browser, findBrowser} from './browser.mjs';

const program = findBrowser();
if (!program) {
  console.log('SKIPPED: the report in a browser: there is no Chromium on the PATH; install the package chromium');
  process.exit(77);
}

const generated = join(scratch, 'generated');
const measured = join(scratch, 'measured');

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
  if (name.endsWith('-mean-height')) return data.agents.length;
  if (name.endsWith('-qos')) return condition.views[view].agents.reduce((sum, agent) => sum + (agent.trials > 1 ? 4 : 1), 0);
  if (name.endsWith('-gain')) return count - 1 + known((agent) => agent.gain.ci95);
  if (name.endsWith('-profile')) return count;
  if (name.endsWith('-energy')) return 2 * count + known((agent) => agent.ci95);
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
  return {data, names};
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
    for (const ending of ['-qos', '-gain', '-profile', '-energy', '-mean-height', '-height-over-steps', '-qos-over-steps', '-heat-map', '-city', '-epsilon', '-loss', '-q-values'])
      assert.ok(names.some((name) => name.endsWith(ending)), `no chart ${ending}`);
    assert.equal(names.filter((name) => name.endsWith('-qos')).length, data.conditions.length);
    assert.deepEqual(data.missing, []);
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
    const bars = await browser.evaluate(`[...document.querySelectorAll('[data-chart$=-qos] g.mark-rect.role-mark path, [data-chart$=-qos] g.mark-rule.role-mark line, [data-chart$=-energy] g.mark-rule.role-mark line')].length`);
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
