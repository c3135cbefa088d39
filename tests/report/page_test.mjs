// The report in a real browser: runs a small experiment, writes its report, looks at every chart.
// Usage: node page_test.mjs ALOFT_PROGRAM SOURCE_FOLDER [SCREENSHOT_FOLDER]

import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {Browser, findBrowser} from './browser.mjs';

const [aloft, sources, pictures] = process.argv.slice(2);
const program = findBrowser();
if (!program) console.log('SKIPPED: no Chromium on the PATH, so nobody has looked at the report; install the package chromium');
const noBrowser = program ? false : 'no Chromium';

const scratch = mkdtempSync(join(tmpdir(), 'aloft-report-test-'));
const agents = ['min-height', 'constant-120', 'random-walk', 'one-step-ahead', 'optimal-height', 'planner', 'dqn'];
const generated = join(scratch, 'generated');
const measured = join(scratch, 'measured');
const everything = scratch;

function run(...given) {
  return spawnSync(aloft, given, {cwd: sources, encoding: 'utf8', timeout: 300000});
}

function succeed(...given) {
  const {status, stderr, stdout} = run(...given);
  assert.equal(status, 0, `aloft ${given.join(' ')}: ${stderr}`);
  return stdout;
}

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
  const flight = condition.flight;
  if (name.endsWith('-mean-height')) return data.agents.length;
  if (name.endsWith('-qos')) return 4 * count;
  if (name.endsWith('-gain')) return 2 * (count - 1);
  if (name.endsWith('-profile')) return count;
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

before(() => {
  const common = ['--in-process', '--trials', '3', '--agents', agents.join(',')];
  succeed('run', 'data/experiments/bs-density.json', '--out', generated, ...common);
  succeed('run', 'data/experiments/measured.json', '--out', measured, ...common);
});
after(() => rmSync(scratch, {recursive: true, force: true}));

describe('the report in a browser', {skip: noBrowser}, () => {
  let browser;
  before(() => { browser = new Browser(program); });
  after(() => browser.close());

  test('generated cities: every chart, light and wide', async () => {
    succeed('report', generated);
    const {data, names} = await checkPage(browser, join(generated, 'report.html'));
    for (const ending of ['-qos', '-gain', '-profile', '-mean-height', '-height-over-steps', '-qos-over-steps', '-heat-map', '-city', '-epsilon', '-loss', '-q-values'])
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

  test('several runs in one page', async () => {
    succeed('report', everything);
    const {data} = await checkPage(browser, join(everything, 'report.html'));
    assert.deepEqual(data.experiments.map((experiment) => experiment.flights_stored), [63, 21]);
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

test('charts as SVG files, the same bytes each time', () => {
  const once = join(scratch, 'svg-once');
  const again = join(scratch, 'svg-again');
  succeed('report', generated, '--svg', once);
  succeed('report', generated, '--svg', again);
  const files = readdirSync(once);
  assert.ok(files.length > 20, `${files.length} files`);
  for (const file of files) {
    const text = readFileSync(join(once, file), 'utf8');
    assert.match(text, /^<svg [^>]*xmlns="http:\/\/www.w3.org\/2000\/svg"/);
    assert.match(text, /role-mark[^>]*>\s*<(path|line|text|g)/, file);
    assert.doesNotMatch(text, /NaN|undefined/, file);
    assert.equal(text, readFileSync(join(again, file), 'utf8'));
  }
});

test('wrong requests end with exit code 2 and say what to do', () => {
  const cases = [
    [['report', join(scratch, 'nowhere')], /no such folder/],
    [['report', join(sources, 'data')], /results\.sqlite/],
    [['report', generated, '--trial', '99'], /--trial: no flight of trial 99/],
    [['report', generated, '--condition', 'bs_density=1'], /--condition: there is no condition .*Allowed/],
    [['report', generated, '--out', join(scratch, 'no', 'such', 'folder.html')], /cannot be written/],
  ];
  for (const [given, message] of cases) {
    const {status, stderr} = run(...given);
    assert.equal(status, 2, given.join(' '));
    assert.match(stderr, message);
  }
  assert.ok(!existsSync(join(scratch, 'no')));
});
