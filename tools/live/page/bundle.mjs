// Bundles the script and the style of the page, each into one file that asks for no other.
// Usage: node bundle.mjs ESBUILD OUTPUT_FOLDER

import {execFileSync} from 'node:child_process';
import {copyFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [esbuild, output] = process.argv.slice(2);
const page = dirname(fileURLToPath(import.meta.url));
const run = (file, ...options) => execFileSync(esbuild, [join(page, file), '--bundle', '--charset=utf8', '--log-level=warning', `--outfile=${join(output, file)}`, ...options], {stdio: 'inherit'});
run('live.js', '--format=iife', "--banner:js='use strict';");
run('live.css');
copyFileSync(join(page, 'live.html'), join(output, 'live.html'));
