// Running the aloft program given on the command line, in a scratch folder that disappears with the test.

import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after} from 'node:test';

export const [aloft, sources, modules, pictures] = process.argv.slice(2);
export const scratch = mkdtempSync(join(tmpdir(), 'aloft-report-test-'));
after(() => rmSync(scratch, {recursive: true, force: true}));

export const agents = ['min-height', 'constant-120', 'random-walk', 'one-step-ahead', 'optimal-height', 'planner', 'dqn'];

export function run(...given) {
  return spawnSync(aloft, given, {cwd: sources, encoding: 'utf8', timeout: 300000});
}

/** The same for a command that must work; returns what it printed. */
export function succeed(...given) {
  const {status, stderr, stdout} = run(...given);
  assert.equal(status, 0, `aloft ${given.join(' ')}: ${stderr}`);
  return stdout;
}

/** Three trials of a shipped experiment, in data/experiments/; over cities with the site map, too. */
export function fly(experiment, folder) {
  succeed('run', `data/experiments/${experiment}.json`, '--out', folder, '--in-process', '--trials', '3', '--agents', [...agents, ...(experiment === 'measured' ? [] : ['site-planner'])].join(','));
}
