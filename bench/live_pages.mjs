// Flights per second of a run while ten pages look at it, against none, in turns.
// A busy machine varies by more than pages cost; the CPU time per flight of the run's processes, and that of the page's own, vary less.
// Usage: node bench/live_pages.mjs ALOFT_PROGRAM [TURNS]
// A page is a viewer of the two event streams that the tabs "Run" and "In the air" take; drawing them is the work of
// another machine.

import {spawn} from 'node:child_process';
import {mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {get} from 'node:http';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

const [aloft, turns = '10'] = process.argv.slice(2);
const pages = 10;
const turn_ms = 4000;
const settle_ms = 2500;  // what nobody looks at any more is still listened to for 2 s
const scratch = mkdtempSync(join(tmpdir(), 'aloft-live-pages-'));
const wait = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

function start(...given) {
  const child = spawn(aloft, given, {stdio: ['ignore', 'pipe', 'pipe']});
  let printed = '';
  const address = new Promise((resolve) => {
    const look = (text) => {
      printed += text;
      const found = /http:\/\/[0-9.:]+\/(?=\s|status)/.exec(printed);
      if (found) resolve(found[0]);
    };
    child.stdout.on('data', look);
    child.stderr.on('data', look);
  });
  return {child, address};
}

/** One page: both tabs at once. Closing it tells whether it has been shown a flight. */
function open(address) {
  let shown = false;
  const requests = ['events/run', 'events/flight?worker=w0'].map((path) => get(address + path, {agent: false}, (answer) => {
    answer.on('data', (text) => { shown ||= String(text).includes('"flight":{'); });
    answer.on('error', () => {});
  }));
  for (const request of requests) request.on('error', () => {});
  return () => { requests.forEach((request) => request.destroy()); return shown; };
}

/** Seconds that these processes, and the processes that they started, have computed. */
function computed(pids) {
  let ticks = 0;
  for (const entry of readdirSync('/proc').filter((name) => /^[0-9]+$/.test(name))) {
    let fields;
    try {
      fields = readFileSync(`/proc/${entry}/stat`, 'utf8').replace(/^.*\) /, '').split(' ');
    } catch {
      continue;  // it has ended
    }
    if (pids.includes(Number(entry)) || pids.includes(Number(fields[1]))) ticks += Number(fields[11]) + Number(fields[12]);
  }
  return ticks / 100;
}

const experiment = join(scratch, 'experiment.json');
writeFileSync(experiment, JSON.stringify({name: 'pages', seed: 1, trials: 1000000, world: {kind: 'generated', bs_density_per_km2: 5, steps: 100}, agents: ['min-height', 'height-filter', 'random-walk', 'constant-120']}));
const name = `pages-${process.pid}`;
const place = ['--run', name, '--domain', '77'];
const collector = start('metrics', experiment, '--out', join(scratch, 'out'), '--http-port', '0', ...place);
const coordinator = start('coordinator', experiment, '--out', join(scratch, 'out'), ...place);
const worker = start('worker', '--join', name, '--name', 'w0', '--domain', '77', '--log-dir', join(scratch, 'log'));
const live = start('live', ...place);
try {
  const status = `${await collector.address}status`;
  const address = await live.address;
  const flights = async () => (await (await fetch(status)).json()).flights_stored;
  for (let tries = 0; tries < 300 && await flights() < 200; ++tries) await wait(100);
  const measured = {0: [], [pages]: []};
  const work = {0: [0, 0, 0], [pages]: [0, 0, 0]};  // flights, seconds of the run's processes, seconds of the page's
  const run = [collector, coordinator, worker].map(({child}) => child.pid);
  for (let turn = 0; turn < Number(turns); ++turn)
    for (const count of turn % 2 === 0 ? [0, pages] : [pages, 0]) {
      const close = Array.from({length: count}, () => open(address));
      await wait(settle_ms);
      const before = await flights();
      const used = [computed(run), computed([live.child.pid])];
      const begun = performance.now();
      await wait(turn_ms);
      const flown = await flights() - before;
      measured[count].push(flown / (performance.now() - begun) * 1000);
      [flown, computed(run) - used[0], computed([live.child.pid]) - used[1]].forEach((amount, i) => { work[count][i] += amount; });
      if (!close.map((one) => one()).every(Boolean)) throw new Error('a page was shown no flight');
    }
  const sum = (values) => values.reduce((total, value) => total + value, 0);
  const ratios = measured[0].map((without, i) => measured[pages][i] / without).sort((a, b) => a - b);
  const rate = (count) => (sum(measured[count]) / turns).toFixed(1);
  console.log(`flights/s without pages ${rate(0)}, with ${pages} pages ${rate(pages)}, ratio ${(sum(measured[pages]) / sum(measured[0])).toFixed(3)} (turns: ${ratios.map((ratio) => ratio.toFixed(2)).join(', ')})`);
  const effort = (count) => 1000 * work[count][1] / work[count][0];
  console.log(`CPU per flight without pages ${effort(0).toFixed(2)} ms, with ${pages} pages ${effort(pages).toFixed(2)} ms, ratio ${(effort(0) / effort(pages)).toFixed(3)}; the page's process takes ${(100 * work[pages][2] / (turns * turn_ms / 1000)).toFixed(1)} % of a core, without a viewer ${(100 * work[0][2] / (turns * turn_ms / 1000)).toFixed(1)} %`);
} finally {
  for (const {child} of [live, worker, coordinator, collector]) {
    child.kill('SIGTERM');
    await new Promise((resolve) => { child.on('exit', resolve); if (child.exitCode !== null || child.signalCode !== null) resolve(); });
  }
  rmSync(scratch, {recursive: true, force: true});
}
