// Writes every chart of a report as a standalone SVG file: runs the scripts that the report itself carries.
// Usage: node render_svg.cjs REPORT.html FOLDER

const fs = require('node:fs');
const path = require('node:path');
const vm = require('node:vm');

const [report, folder] = process.argv.slice(2);
const html = fs.readFileSync(report, 'utf8');

function block(id) {
  const start = html.indexOf(`id="${id}">`);
  if (start < 0) throw new Error(`${report}: no block "${id}"; is it a report written by this version?`);
  const from = start + `id="${id}">`.length;
  return html.slice(from, html.indexOf('</script>', from));
}

for (const id of ['vega', 'vega-lite', 'charts']) vm.runInThisContext(`(function (exports, module, define) {${block(id)}\n}).call(globalThis)`, {filename: id});

async function main() {
  const data = JSON.parse(block('report-data'));
  const charts = globalThis.aloftCharts.allCharts(data, {theme: 'light', width: 640, view: 'all'});
  for (const {name, spec} of charts) {
    const view = new globalThis.vega.View(globalThis.vega.parse(globalThis.vegaLite.compile(spec).spec), {renderer: 'none'});
    fs.writeFileSync(path.join(folder, `${name}.svg`), await view.toSVG());
    view.finalize();
  }
  console.log(charts.length);
}

main().catch((error) => {
  console.error(error.stack);
  process.exitCode = 1;
});
