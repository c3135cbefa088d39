// What the report command writes and refuses, without a browser.
// Usage: node files_test.mjs ALOFT_PROGRAM SOURCE_FOLDER

import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {existsSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {findBrowser} from './browser.mjs';
import {aloft, fly, run, scratch, sources, succeed} from './aloft.mjs';

const generated = join(scratch, 'generated');

before(() => fly('bs-density', generated));

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

test('box plots of agents that see the future are hollow, of those with the site map light, and labels carry the mark of the tier', () => {
  const folder = join(scratch, 'svg-marks');
  succeed('report', generated, '--svg', folder);
  const plots = readdirSync(folder).filter((file) => file.endsWith('-qos.svg'));
  assert.equal(plots.length, 3);
  for (const file of plots) {
    const text = readFileSync(join(folder, file), 'utf8');
    for (const label of ['one-step-ahead *', 'optimal-height *', 'planner **', 'site-planner +', 'dqn']) assert.ok(text.includes(`>${label}<`), `${file}: ${label}`);
    const boxes = /role-mark layer_1_marks.*?<\/g>/s.exec(text)[0];
    const fills = [...boxes.matchAll(/fill="([^"]*)"/g)].map(([, fill]) => fill).filter((fill) => fill !== 'none');
    assert.equal(fills.filter((fill) => fill === '#ffffff').length, 3, `${file}: ${fills}`);
    assert.equal(fills.filter((fill) => fill === '#a99ad5').length, 1, `${file}: ${fills}`); // half of #5335aa
  }
});

test('tables for LaTeX: one per condition, and it compiles where there is a LaTeX', (context) => {
  const file = join(scratch, 'tables.tex');
  assert.match(succeed('report', generated, '--latex', file), /tables\.tex\n$/);
  const text = readFileSync(file, 'utf8');
  assert.equal(text.split('\\begin{table}').length, 4);
  assert.match(text, /^ {4}planner \*\* & foresight & 3 & \$/m);
  assert.match(text, /^ {4}site-planner \+ & site map & 3 & /m);
  assert.doesNotMatch(text, /[^\\][_#]|²|NaN/);
  const main = join(scratch, 'main.tex');
  writeFileSync(main, '\\documentclass{article}\\usepackage{booktabs}\\begin{document}\\input{tables}\\end{document}\n');
  const made = spawnSync('pdflatex', ['-interaction=nonstopmode', '-halt-on-error', 'main.tex'], {cwd: scratch, encoding: 'utf8', timeout: 60000});
  if (made.error) context.diagnostic('no pdflatex here: the text is checked, not compiled');
  else assert.equal(made.status, 0, made.stdout);
});

test('a printed report is a PDF with pages; without Chromium nothing is written', (context) => {
  const file = join(scratch, 'report.pdf');
  const html = join(scratch, 'printed.html');
  const {status, stderr} = spawnSync(aloft, ['report', generated, '--out', html, '--pdf', file], {cwd: sources, encoding: 'utf8', env: {PATH: scratch}});
  assert.equal(status, 2, stderr);
  assert.match(stderr, /--pdf: needs Chromium or Chrome.*install the package chromium/s);
  assert.ok(!existsSync(file) && !existsSync(html));
  if (!findBrowser()) return context.diagnostic('no Chromium here: nothing is printed');
  succeed('report', generated, '--out', html, '--pdf', file, '--chromium', findBrowser());
  const bytes = readFileSync(file, 'latin1');
  assert.ok(bytes.startsWith('%PDF'));
  const pages = bytes.match(/\/Type\s*\/Page\b/g).length;
  assert.ok(pages > 5 && pages < 60, `${pages} pages`);
});

test('wrong requests end with exit code 2 and say what to do', () => {
  const cases = [
    [['report', join(scratch, 'nowhere')], /no such folder/],
    [['report', join(sources, 'data')], /results\.sqlite/],
    [['report', generated, '--trial', '99'], /--trial: no flight of trial 99/],
    [['report', generated, '--condition', 'bs_density=1'], /--condition: there is no condition .*Allowed/],
    [['report', generated, '--out', join(scratch, 'no', 'such', 'folder.html')], /cannot be written/],
    [['report', generated, '--latex', join(scratch, 'no', 'tables.tex')], /--latex: there is no folder/],
    [['report', generated, '--pdf', join(scratch, 'x.pdf'), '--chromium', '/no/such'], /--chromium: there is no program '\/no\/such'/],
  ];
  for (const [given, message] of cases) {
    const {status, stderr} = run(...given);
    assert.equal(status, 2, given.join(' '));
    assert.match(stderr, message);
  }
  assert.ok(!existsSync(join(scratch, 'no')));
});
