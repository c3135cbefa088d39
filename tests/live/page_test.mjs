// The page of `aloft live` in a real browser: looks at stored flights, and at a run whose worker is killed.
// Usage: node page_test.mjs ALOFT_PROGRAM SOURCE_FOLDER NODE_MODULES [SCREENSHOT_FOLDER]

import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {aloft, modules, pictures, run, scratch, sources, succeed} from '../report/aloft.mjs';
import {Browser, findBrowser} from '../report/browser.mjs';

const program = findBrowser();
if (!program) {
  console.log('SKIPPED: the live page in a browser: there is no Chromium on the PATH; install the package chromium');
  process.exit(77);
}

const axe = readFileSync(join(modules, 'axe-core', 'axe.min.js'), 'utf8');
const results = join(scratch, 'results');

/** Starts aloft and waits for the address that it prints. */
async function started(...given) {
  const server = spawn(aloft, given, {cwd: sources, stdio: ['ignore', 'pipe', 'pipe']});
  const ended = new Promise((resolve) => { server.on('exit', resolve); });
  let printed = '';
  const address = await new Promise((resolve, reject) => {
    const look = (text) => {
      printed += text;
      const found = /http:[^\s]+(?=\s)/.exec(printed);
      if (found) resolve(found[0]);
    };
    server.stdout.on('data', look);
    server.stderr.on('data', look);
    server.on('exit', () => reject(new Error(`aloft ${given.join(' ')} ended: ${printed}`)));
  });
  return {address, ended, printed: () => printed, stop: async () => { server.kill('SIGINT'); return ended; }};
}

const serve = (...given) => started('live', ...given);

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

/** Waits until the expression is true in the page. */
async function comesTrue(browser, expression, limit_s = 10) {
  for (const until = Date.now() + 1000 * limit_s; Date.now() < until;) {
    if (await browser.evaluate(expression)) return;
    await new Promise((resolve) => { setTimeout(resolve, 50); });
  }
  assert.fail(`never true: ${expression}`);
}

/** The cells of the table of the step that is shown: one row per agent. */
const shownRows = `[...document.querySelectorAll('#tab-flight tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent))`;

describe('a replay', {timeout: 300000}, () => {
  let browser;
  let page;
  before(async () => {
    const experiment = join(scratch, 'experiment.json');
    writeFileSync(experiment, JSON.stringify({name: 'seen', description: '<b>Not bold</b>', seed: 5, trials: 2, world: {kind: 'generated', bs_density_per_km2: [1, 2.5, 5], steps: 40}, agents: ['min-height', {type: 'dqn', epochs: 20}, 'planner']}));
    succeed('run', experiment, '--out', results, '--in-process');
    browser = new Browser(program);
    page = await serve(results);
  });
  after(async () => {
    await browser?.close();
    assert.equal(await page?.stop(), 0);
  });

  test('a link names condition, trial, agent and step, and the numbers are those of the store', async () => {
    const steps = JSON.parse(succeed('export', results, '--steps', '--format', 'json')).filter((row) => row.condition.endsWith('=2.5') && row.trial === 1 && row.step === 17);
    assert.equal(steps.length, 3);
    await browser.open(`${page.address}#tab=flight&condition=1&trial=1&agent=dqn&step=17`);
    const rows = await browser.evaluate(shownRows);
    assert.ok(await browser.evaluate('document.querySelector("header p").textContent === "<b>Not bold</b>"'));
    assert.deepEqual(rows.map((row) => row[0].split(' ')[0]).sort(), ['dqn', 'min-height', 'planner']);
    for (const row of rows) {
      const stored = steps.find((step) => step.agent === row[0].split(' ')[0]);
      assert.equal(row[1], stored.height_m.toFixed(0));
      assert.equal(row[2], String(stored.serving_cell));
      assert.equal(row[3].replace('−', '-'), stored.serving_sinr_db.toFixed(1));
      assert.equal(row[4], stored.qos.toFixed(2));
    }
    assert.match(await browser.evaluate('location.hash'), /condition=1&trial=1&agent=dqn&step=17$/);
    await picture(browser, 'replay');
    assert.deepEqual(browser.complaints, []);
    for (const request of browser.requests) assert.ok(request.startsWith(page.address) || request === 'about:blank' || request.startsWith('data:'), request);
  });

  test('play, pause and steps, by buttons and keys', async () => {
    const press = (label) => browser.evaluate(`document.querySelector('[aria-label="${label}"]').click()`);
    const step = () => browser.evaluate('document.querySelector(".transport output").textContent');
    const key = (name) => browser.evaluate(`document.body.dispatchEvent(new KeyboardEvent('keydown', {key: '${name}', bubbles: true}))`);
    await press('First step');
    assert.equal(await step(), 'step 1 of 40');
    await press('One step on');
    await key('ArrowRight');
    assert.equal(await step(), 'step 3 of 40');
    await key('ArrowLeft');
    assert.equal(await step(), 'step 2 of 40');
    await press('Last step');
    await press('One step on');
    assert.equal(await step(), 'step 40 of 40');
    await key(' ');  // plays from the beginning
    await comesTrue(browser, 'document.querySelector(".transport output").textContent === "step 5 of 40"');
    await key(' ');
    const paused = await step();
    await new Promise((resolve) => { setTimeout(resolve, 400); });
    assert.equal(await step(), paused);
    await browser.evaluate(`(() => { const slider = document.querySelector('input[type=range]'); slider.value = 9; slider.dispatchEvent(new Event('input')); })()`);
    assert.equal(await step(), 'step 10 of 40');
    assert.match(await browser.evaluate('location.hash'), /step=10$/);
  });

  test('the canvases show something in both themes, and the page is no wider than a phone', async () => {
    const drawn = `[...document.querySelectorAll('#tab-flight canvas')].map((canvas) => new Set(new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size)`;
    for (const [width, scheme] of [[1280, 'light'], [1280, 'dark'], [400, 'light'], [400, 'dark']]) {
      await browser.open(`${page.address}#tab=flight&condition=2&trial=0&agent=dqn&step=30`, {width, scheme});
      const colours = await browser.evaluate(drawn);
      assert.equal(colours.length, 8);  // the city, four quantities, and what a learner tells
      for (const count of colours) assert.ok(count > 10, `${width} ${scheme}: ${colours}`);
      assert.ok(await browser.evaluate('document.documentElement.scrollWidth <= window.innerWidth'), `wider than ${width}`);
      assert.deepEqual(await barriers(browser), []);
      await picture(browser, `replay-${width}-${scheme}`);
    }
  });

  test('the results are those of the summary', async () => {
    await browser.open(`${page.address}#tab=results`);
    const rows = await browser.evaluate(`[...document.querySelectorAll('#tab-results tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent))`);
    const flights = JSON.parse(succeed('export', results, '--flights', '--format', 'json'));
    const of = (agent) => flights.filter((flight) => flight.condition.endsWith('=1') && flight.agent === agent).map((flight) => flight.qos_mean);
    const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
    for (const row of rows.slice(0, 3)) {
      const agent = row[0].split(' ')[0];
      assert.equal(row[1], '2');
      assert.equal(row[2], mean(of(agent)).toFixed(3));
      assert.equal(row[4].replace('−', '-'), (mean(of(agent)) - mean(of('min-height')) < 0 ? '' : '+') + (mean(of(agent)) - mean(of('min-height'))).toFixed(3));
    }
    assert.deepEqual(await barriers(browser), []);
    await picture(browser, 'replay-results');
  });

  test('what is not there is said', async () => {
    for (const [path, status, text] of [['data/flight?condition=99&trial=0', 400, 'condition 99'], ['data/flight?condition=0&trial=77', 400, 'trial 77'], ['data/flight?trial=1', 400, "'condition' must be a whole number"], ['nothing', 404, '/data/flight']]) {
      const answer = await fetch(page.address + path);
      assert.equal(answer.status, status);
      assert.ok((await answer.text()).includes(text), path);
    }
    const refused = run('live', join(scratch, 'nowhere'));
    assert.equal(refused.status, 2);
    assert.match(refused.stderr, /nowhere/);
  });
});

describe('a run', {timeout: 300000}, () => {
  const name = `live-${process.pid}`;
  const place = ['--domain', String(process.pid % 90)];
  const folder = join(scratch, 'run');
  const children = [];
  let browser;
  let page;
  const start = (...given) => {
    const child = spawn(aloft, [...given, ...place], {cwd: sources, stdio: 'ignore'});
    children.push(child);
    return child;
  };
  before(async () => {
    const experiment = join(scratch, 'long.json');
    writeFileSync(experiment, JSON.stringify({name: 'long', seed: 5, trials: 4000, world: {kind: 'generated', bs_density_per_km2: [1, 5], steps: 40}, agents: ['min-height', {type: 'dqn', epochs: 40}]}));
    for (const service of ['coordinator', 'metrics']) start(service, experiment, '--run', name, '--out', folder);
    browser = new Browser(program);
    page = await serve('--run', name, ...place);
  });
  after(async () => {
    await browser?.close();
    assert.equal(await page?.stop(), 0);
    for (const child of children) child.kill('SIGKILL');
  });

  const rows = `[...document.querySelectorAll('#tab-run tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent))`;

  test('the page tells what aloft status tells, and shows a killed worker as lost within 4 s', async () => {
    const worker = start('worker', '--join', name, '--name', '<script>', '--log-dir', join(scratch, 'log'));
    await new Promise((resolve) => { worker.on('exit', resolve); });  // such a name is refused
    const good = start('worker', '--join', name, '--name', 'w0', '--log-dir', join(scratch, 'log'));
    await browser.open(page.address);
    await comesTrue(browser, `document.querySelector('#tab-run tbody')?.textContent.includes('alive')`);
    await comesTrue(browser, `document.querySelectorAll('#tab-run dd')[1].textContent.endsWith(' of 16000')`);
    const told = JSON.parse(succeed('status', '--run', name, ...place, '--format', 'json')).runs[0];
    const shown = await browser.evaluate(rows);
    assert.deepEqual(shown.map((row) => row[0]), told.workers.map((known) => known.worker));
    assert.equal(shown[0][1], told.workers[0].host);
    assert.equal(told.flights_total, 16000);
    assert.ok(Number(shown[0][4]) <= told.workers[0].flights_done + 200);
    await picture(browser, 'run');
    process.kill(told.workers[0].pid, 'SIGKILL');
    good.kill('SIGKILL');  // which would start it again
    const killed = Date.now();
    await comesTrue(browser, `document.querySelector('#tab-run .notice')?.textContent.includes('worker w0 on')`);
    assert.ok(Date.now() - killed < 4500, `${Date.now() - killed} ms`);  // half a second for the event and the look
    assert.equal((await browser.evaluate(rows))[0][2], 'lost');
    assert.deepEqual(await barriers(browser), []);
    await picture(browser, 'run-lost');
    assert.deepEqual(browser.complaints, []);
  });

  test('names from the wire are text, whatever they are', async () => {
    const evil = '<script>document.title="run"</script><img src=x onerror="document.title=1">';
    const worker = {worker: evil, host: evil, pid: 1, state: 'lost', silent_s: 5, capacity: 1, leases: [], agents: [{agent: evil, type: evil, process: evil, state: 'lost', silent_s: 9, flights: 0}], flights_done: 0, flights_per_s: 0, steps_done: 0, steps_per_s: 0, answer_p50_ms: null, answer_p99_ms: null, records_unconfirmed: 0, drops: 0, missing: evil, failures: [{lease: evil, reason: evil}]};
    const run = {run: evil, experiment: evil, middleware: [evil], state: 'running', flights_total: 1, flights_stored: 0, flights_per_s: 0, steps_per_s: 0, eta_s: null, trials: {pending: 0, leased: 0, done: 0, failed: 0}, message: evil, collector: {state: 'storing', message: evil}, workers: [worker, {...worker, state: 'alive'}]};
    const flight = {stream: 0, streams: [{stream: 0, agent: evil, condition: 0, trial: 0}], flight: {condition: 0, trial: 0, over: false, step: [1], height_min_m: 0, height_max_m: 9, height_step_m: 1, agents: [{name: evil, stream: 0, at: 1, learning: null, height_m: [1], qos: [1], serving_cell: [0], x_m: [0], y_m: [0], sinr_db: [1], reward: [1]}]}};
    const overview = {title: evil, description: evil, source: evil, agents: [], privilege_tiers: [{name: 'none', mark: '', sees: '', knows: '', shape: 'full'}], marks_explained: '', conditions: [{label: evil, qos_name: evil, qos_unit: evil, trials: []}], run: evil, stored: null, operator: true};
    const fake = createServer(async (request, answer) => {
      const path = new URL(request.url, 'http://x').pathname;
      const events = {'/events/run': run, '/events/flight': flight}[path];
      const data = {'/data/overview': overview, '/data/world': {city: null, route: null, map: null}}[path];
      if (events) {
        answer.writeHead(200, {'Content-Type': 'text/event-stream'});
        answer.write(`data: ${JSON.stringify(events)}\n\n`);
      } else if (data) {
        answer.end(JSON.stringify(data));
      } else {  // the page itself; without its policy, which would hide what this test looks for
        const file = await fetch(page.address + path.slice(1));
        answer.setHeader('Content-Type', file.headers.get('content-type'));
        answer.end(await file.text());
      }
    });
    await new Promise((resolve) => { fake.listen(0, '127.0.0.1', resolve); });
    const address = `http://127.0.0.1:${fake.address().port}/`;
    for (const tab of ['run', 'live']) {
      await browser.open(`${address}#tab=${tab}&token=t`);
      await comesTrue(browser, `document.querySelector('#tab-${tab} tbody')?.textContent.includes('<script>')`);
      assert.equal(await browser.evaluate('document.querySelectorAll("img, script:not([src])").length'), 0);
      assert.match(await browser.evaluate('document.title'), /^<script>/);
    }
    fake.closeAllConnections();
    await new Promise((resolve) => { fake.close(resolve); });
  });

  test('without a run and without a folder there is nothing to watch', () => {
    const refused = run('live');
    assert.equal(refused.status, 2);
    assert.match(refused.stderr, /--run NAME/);
  });
});

describe('aloft run --live', {timeout: 300000}, () => {
  const name = `lively-${process.pid}`;
  const place = ['--domain', String(process.pid % 90)];
  const folder = join(scratch, 'lively');
  let browser;
  let live;
  before(async () => {
    const experiment = join(scratch, 'lively.json');
    // Long enough to look at; ended by Ctrl-C.
    writeFileSync(experiment, JSON.stringify({name: 'lively', seed: 5, on_agent_loss: 'failover', trials: 40000, world: {kind: 'generated', bs_density_per_km2: 5, steps: 40}, agents: [{type: 'dqn', epochs: 40}, 'planner', 'min-height', {type: 'relay', name: 'uav', crew: [{agent: 'random-walk'}, {agent: 'min-height'}]}]}));
    live = await started('run', experiment, '--out', folder, '--run', name, '--workers', '1', '--live', '--operator', ...place);
    browser = new Browser(program);
  });
  after(async () => {
    await browser?.close();
    await live?.stop();
  });
  const base = () => live.address.split('#')[0];

  test('the world that is shown is flown by all agents, and its numbers are those of the store', async () => {
    await browser.open(`${base()}#tab=live`);
    await comesTrue(browser, `document.querySelectorAll('#tab-live tbody tr').length === 4 && document.querySelector('#tab-live').textContent.includes('flown; the next')`);
    const shown = await browser.evaluate(`({note: document.querySelector('#tab-live > p.soft').textContent, rows: [...document.querySelectorAll('#tab-live tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent)), streams: [...document.querySelectorAll('#choose-stream option')].map((option) => option.textContent)})`);
    const trial = Number(/trial (\d+)/.exec(shown.note)[1]);
    let steps = [];
    for (let wait = 0; wait < 50 && steps.length < 4; ++wait) {
      const all = run('export', folder, '--steps', '--format', 'json', '--trial', String(trial));
      steps = all.status === 0 ? JSON.parse(all.stdout).filter((row) => row.step === 40) : [];
      await new Promise((resolve) => { setTimeout(resolve, 100); });
    }
    assert.equal(steps.length, 4);
    for (const row of shown.rows) {
      const stored = steps.find((step) => step.agent === row[0].split(' ')[0]);
      assert.equal(row[1], '40');
      assert.equal(row[2], stored.height_m.toFixed(0));
      assert.equal(row[3], String(stored.serving_cell));
      assert.equal(row[4].replace('−', '-'), stored.serving_sinr_db.toFixed(1));
      assert.equal(row[5], stored.qos.toFixed(2));
    }
    assert.ok(shown.streams.some((text) => text.endsWith('planner **')), String(shown.streams));
    const charts = await browser.evaluate(`[...document.querySelectorAll('#tab-live figcaption')].map((caption) => caption.textContent).join('; ')`);
    assert.match(charts, /seen ahead by planner \*\* alone/);
    assert.deepEqual(await barriers(browser), []);
    assert.deepEqual(browser.complaints, []);
  });

  test('another stream is followed when it is chosen, and the address names it', async () => {
    for (const agent of ['min-height', 'dqn']) {
      await browser.evaluate(`(() => { const list = document.querySelector('#choose-stream'); list.value = [...list.options].find((option) => option.textContent.includes('${agent}')).value; list.dispatchEvent(new Event('change')); })()`);
      await comesTrue(browser, `document.querySelector('#tab-live tr.chosen')?.textContent.startsWith('${agent}')`);
      await comesTrue(browser, `document.querySelector('#tab-live').textContent.includes('Exploration rate') === ${agent === 'dqn'}`);  // what a learner tells
    }
    assert.match(await browser.evaluate('location.hash'), /tab=live&worker=w0&stream=\d+$/);
  });

  test('the canvases show something, and the pages are no wider than a phone', async () => {
    for (const [width, scheme] of [[1280, 'light'], [400, 'dark'], [400, 'light']]) {
      for (const tab of ['live', 'run', 'results']) {
        await browser.open(`${base()}#tab=${tab}`, {width, scheme});
        await comesTrue(browser, `document.querySelector('#tab-${tab} tbody') !== null`);
        assert.ok(await browser.evaluate('document.documentElement.scrollWidth <= window.innerWidth'), `${tab} wider than ${width}`);
        if (tab === 'live') {
          await comesTrue(browser, `[...document.querySelectorAll('#tab-live canvas')].every((canvas) => new Set(new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size > 10)`);
          await comesTrue(browser, `document.querySelector('#tab-live').textContent.includes('flown; the next')`);
        }
        await picture(browser, `${tab}-${width}-${scheme}`);
      }
    }
  });

  test('results come as flights are stored', async () => {
    await browser.open(`${base()}#tab=results`);
    const stored = `Number(/Results of (\\d+) of 160000/.exec(document.querySelector('#tab-results').textContent)?.[1] ?? 0)`;
    const before = await browser.evaluate(stored);
    await comesTrue(browser, `${stored} > ${before}`, 60);  // the longer it takes to compute, the more seldom
    assert.deepEqual(await barriers(browser), []);
  });

  test('orders need the token of the printed address', async () => {
    const token = /#token=([0-9a-f]{32})$/.exec(live.address)[1];
    const order = (headers, method = 'POST') => fetch(`${base()}swap?worker=w0&agent=random-walk`, {method, headers});
    assert.equal((await order({})).status, 403);
    assert.equal((await order({Authorization: `Bearer ${token.replace(/.$/, 'g')}`})).status, 403);
    assert.equal((await order({Authorization: `Bearer ${token}`, Origin: 'http://attacker.example'})).status, 403);
    assert.equal((await order({Authorization: `Bearer ${token}`}, 'GET')).status, 405);
    const control = `document.querySelector('#swap button') !== null`;
    const reader = new Browser(program);  // who has the address without the token
    await reader.open(base());
    await comesTrue(reader, `document.querySelector('#tab-run tbody') !== null`);
    assert.ok(!await reader.evaluate(control));
    await reader.close();
    await browser.open(live.address);
    await comesTrue(browser, control);
    assert.ok(!await browser.evaluate('location.hash.includes("token")'));
    await browser.evaluate(`(() => { const agent = document.querySelectorAll('#swap select')[1]; agent.value = 'min-height'; agent.dispatchEvent(new Event('change')); document.querySelector('#swap button').click(); })()`);
    assert.match(await browser.evaluate(`document.querySelector('dialog[open]').textContent`), /From the next step on, min-height flies the relays of worker w0/);
    assert.deepEqual(await barriers(browser), []);
    await picture(browser, 'swap');
    await browser.evaluate(`document.querySelector('dialog[open] button').click()`);
    await comesTrue(browser, `/min-height flies/.test(document.querySelector('#swap p[role=status]').textContent)`);
    const refused = await (await fetch(`${base()}swap?worker=nobody&agent=min-height`, {method: 'POST', headers: {Authorization: `Bearer ${token}`}})).text();
    assert.match(refused, /no worker 'nobody'/);
  });

  test('without --operator there is no such route and no control', async () => {
    const other = await serve('--run', name, ...place);
    assert.equal((await fetch(`${other.address}swap?worker=w0&agent=min-height`, {method: 'POST', headers: {Authorization: 'Bearer x'}})).status, 405);
    assert.equal((await fetch(`${other.address}swap`)).status, 404);
    await browser.open(`${other.address}#token=${'0'.repeat(32)}`);
    await comesTrue(browser, `document.querySelector('#tab-run tbody') !== null`);
    assert.ok(!await browser.evaluate(`document.querySelector('#swap button') !== null`));
    assert.equal(await other.stop(), 0);
  });

  test('the page ends with the run, and says how to see the flights', async () => {
    await browser.open(`${base()}#tab=run`);
    await comesTrue(browser, `document.querySelector('#tab-run tbody') !== null`);
    assert.equal(await live.stop(), 130);
    await comesTrue(browser, `document.querySelector('#tab-run').textContent.includes('aloft live does not answer')`);
    assert.ok(await browser.evaluate(`document.querySelector('#tab-run').textContent.includes(${JSON.stringify(`aloft live ${folder}`)})`));
    assert.ok(live.printed().includes(`aloft live ${folder}`));
    await assert.rejects(fetch(base()));
  });
});

describe('without a run on the bus', {timeout: 60000}, () => {
  const experiment = join(scratch, 'short.json');
  before(() => { writeFileSync(experiment, JSON.stringify({name: 'short', seed: 5, trials: 2, world: {kind: 'generated', bs_density_per_km2: 5, steps: 10}, agents: ['min-height']})); });

  test('a desktop opens the page by itself, others get the address alone', async () => {
    const programs = join(scratch, 'bin');
    const opened = join(scratch, 'opened');
    mkdirSync(programs);
    writeFileSync(join(programs, 'xdg-open'), `#!/bin/sh\necho "$1" >> ${opened}\n`, {mode: 0o755});
    const inTerminal = (out, environment) => spawnSync('script', ['-qec', `${aloft} run ${experiment} --in-process --live --out ${join(scratch, out)}`, '/dev/null'], {encoding: 'utf8', env: {...process.env, PATH: `${programs}:${process.env.PATH}`, DISPLAY: '', WAYLAND_DISPLAY: '', ...environment}});
    for (const [out, environment] of [['x11', {DISPLAY: ':0'}], ['wayland', {WAYLAND_DISPLAY: 'wayland-0'}]]) {
      rmSync(opened, {force: true});
      const finished = inTerminal(out, environment);
      assert.equal(finished.status, 0, finished.stdout);
      const address = /Watch it at (http:\S+)/.exec(finished.stdout)[1];
      for (let wait = 0; wait < 100 && !existsSync(opened); ++wait) await new Promise((resolve) => { setTimeout(resolve, 50); });
      assert.equal(readFileSync(opened, 'utf8').trim(), address);
    }
    rmSync(opened);
    assert.match(inTerminal('text', {}).stdout, /Watch it at http/);
    const piped = spawnSync(aloft, ['run', experiment, '--in-process', '--live', '--out', join(scratch, 'piped')], {encoding: 'utf8', env: {...process.env, PATH: `${programs}:${process.env.PATH}`, DISPLAY: ':0'}});
    assert.match(piped.stderr, /Watch it at http/);
    assert.ok(!existsSync(opened));
  });

  test('orders are refused where nobody can take them', () => {
    for (const [given, words] of [
      [['run', experiment, '--operator'], '--live'],
      [['run', experiment, '--operator', '--live', '--in-process'], '--in-process'],
      [['live', join(scratch, 'results'), '--operator'], '--run NAME'],
    ]) {
      const refused = run(...given);
      assert.equal(refused.status, 2);
      assert.ok(refused.stderr.includes(words), refused.stderr);
    }
  });
});
