// Puts the page, its scripts and the chart libraries into one HTML file whose data block is still "%DATA%".
// Usage: node bundle.mjs ESBUILD NODE_MODULES OUTPUT.html

import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [esbuild, modules, output] = process.argv.slice(2);
const page = join(dirname(fileURLToPath(import.meta.url)), 'page');
const read = (file) => readFileSync(file, 'utf8');

/** An ES module with all that it imports, as one script; modules are strict, so it is, too. */
function bundle(module) {
  const options = ['--bundle', '--format=iife', '--charset=utf8', "--banner:js='use strict';", '--log-level=warning'];
  return execFileSync(esbuild, options, {cwd: page, input: module, encoding: 'utf8', stdio: ['pipe', 'pipe', 'inherit']});
}

function inline(code, name) {
  if (/<\/script|<!--/i.test(code)) throw new Error(`${name} holds "</script" or "<!--" and cannot be inlined`);
  return code.replace(/^\/\/# sourceMappingURL=.*$/gm, '');
}

const parts = {
  STYLE: read(join(page, 'style.css')),
  VEGA: read(join(modules, 'vega/build/vega.min.js')),
  VEGA_LITE: read(join(modules, 'vega-lite/build/vega-lite.min.js')),
  VEGA_EMBED: read(join(modules, 'vega-embed/build/vega-embed.min.js')),
  CHARTS: bundle("import {allCharts} from './charts.js'; globalThis.aloftCharts = {allCharts};"),
  PAGE: bundle("import './page.js';"),
};
const html = read(join(page, 'page.html')).replace(/%([A-Z_]+)%/g, (whole, name) => (parts[name] === undefined ? whole : inline(parts[name], name)));
writeFileSync(output, html);
