// Puts the page, its scripts and the chart libraries into one HTML file whose data block is still "%DATA%".
// Usage: node bundle.mjs NODE_MODULES OUTPUT.html

import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [modules, output] = process.argv.slice(2);
const page = join(dirname(fileURLToPath(import.meta.url)), 'page');
const read = (file) => readFileSync(file, 'utf8');

/** Our ES modules, each after those it imports, as one strict function: `import` lines and `export` words fall away. */
function concatenate(files, exported) {
  const code = files.map((file) => read(join(page, file)).replace(/^import .*;\n/gm, '').replace(/^export /gm, '')).join('\n');
  return `(() => {\n'use strict';\n${code}\n${exported}})();`;
}

function inline(code, name) {
  if (/<\/script|<!--/i.test(code)) throw new Error(`${name} holds "</script" or "<!--" and cannot be inlined`);
  return code.replace(/^\/\/# sourceMappingURL=.*$/gm, '');
}

const charts = ['format.js', 'theme.js', 'privilege.js', 'charts_statistics.js', 'charts_flight.js', 'charts.js'];
const parts = {
  STYLE: read(join(page, 'style.css')),
  VEGA: read(join(modules, 'vega/build/vega.min.js')),
  VEGA_LITE: read(join(modules, 'vega-lite/build/vega-lite.min.js')),
  VEGA_EMBED: read(join(modules, 'vega-embed/build/vega-embed.min.js')),
  CHARTS: concatenate(charts, 'globalThis.aloftCharts = {allCharts};\n'),
  PAGE: concatenate([...charts, 'dom.js', 'sections.js', 'page.js'], ''),
};
const html = read(join(page, 'page.html')).replace(/%([A-Z_]+)%/g, (whole, name) => (parts[name] === undefined ? whole : inline(parts[name], name)));
writeFileSync(output, html);
