// Headless Chromium over its DevTools pipe: opens a page, collects what it complains about, evaluates expressions.

import {spawn} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {delimiter, join} from 'node:path';

const limit_ms = 60000;

/** The browser's path, or null: then the caller skips, loudly. */
export function findBrowser() {
  for (const name of ['chromium', 'chromium-browser', 'google-chrome', 'chrome'])
    for (const folder of (process.env.PATH ?? '').split(delimiter)) if (existsSync(join(folder, name))) return join(folder, name);
  return null;
}

export class Browser {
  #next = 1;
  #waiting = new Map();
  #text = '';

  constructor(program) {
    this.profile = mkdtempSync(join(tmpdir(), 'aloft-browser-'));
    this.process = spawn(program, ['--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run', '--disable-extensions',
      '--disable-background-networking', '--disable-component-update', `--user-data-dir=${this.profile}`, '--remote-debugging-pipe', 'about:blank'],
    {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    this.process.stdio[4].on('data', (chunk) => this.#receive(chunk));
    this.process.on('exit', () => {
      for (const {reject} of this.#waiting.values()) reject(new Error('the browser ended'));
    });
    this.complaints = [];
    this.requests = [];
  }

  #receive(chunk) {
    this.#text += chunk;
    const messages = this.#text.split('\0');
    this.#text = messages.pop();
    for (const message of messages) this.#handle(JSON.parse(message));
  }

  #handle({id, result, error, method, params}) {
    if (id) {
      const {resolve, reject} = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error) reject(new Error(error.message));
      else resolve(result);
    } else if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type)) {
      this.complaints.push(params.args.map((argument) => argument.value ?? argument.description).join(' '));
    } else if (method === 'Runtime.exceptionThrown') {
      this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    } else if (method === 'Log.entryAdded' && params.entry.level === 'error') {
      this.complaints.push(params.entry.text);
    } else if (method === 'Network.requestWillBeSent') {
      this.requests.push(params.request.url);
    }
  }

  #send(method, params = {}) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`the browser did not answer ${method} within ${limit_ms / 1000} s`)), limit_ms);
      const settle = (then) => (value) => { clearTimeout(timer); then(value); };
      this.#waiting.set(id, {resolve: settle(resolve), reject: settle(reject)});
      this.process.stdio[3].write(`${JSON.stringify({id, method, params, sessionId: this.session})}\0`);
    });
  }

  /** Opens a page of this width and colour scheme and waits until it says that it is ready or has failed. */
  async open(url, {width = 1280, scheme = 'light'} = {}) {
    if (!this.session) {
      const {targetId} = await this.#send('Target.createTarget', {url: 'about:blank'});
      this.session = (await this.#send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
      for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await this.#send(`${domain}.enable`);
    }
    await this.#send('Emulation.setDeviceMetricsOverride', {width, height: 900, deviceScaleFactor: 1, mobile: width < 600});
    await this.#send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: scheme}]});
    this.complaints = [];
    this.requests = [];
    await this.#send('Page.navigate', {url: 'about:blank'});
    await this.#send('Page.navigate', {url});
    await this.ready();
  }

  /** Waits for body[data-ready] or body[data-error]. */
  async ready() {
    const deadline = Date.now() + limit_ms;
    while (!await this.evaluate('document.body !== null && (document.body.hasAttribute("data-ready") || document.body.hasAttribute("data-error"))')) {
      if (Date.now() > deadline) throw new Error(`the page was not ready within ${limit_ms / 1000} s; it complained: ${this.complaints.join('; ') || 'nothing'}`);
      await new Promise((resolve) => { setTimeout(resolve, 50); });
    }
  }

  /** The value of an expression in the page. */
  async evaluate(expression) {
    const {result, exceptionDetails} = await this.#send('Runtime.evaluate', {expression, returnByValue: true, awaitPromise: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Presses a key that is its own text ("a", " ") or has a name ("Enter", "Tab"). */
  async press(key) {
    const text = key === 'Enter' ? '\r' : key.length === 1 ? key : undefined;
    const code = {Enter: 13, Tab: 9}[key] ?? key.charCodeAt(0);
    for (const type of [text ? 'keyDown' : 'rawKeyDown', 'keyUp']) await this.#send('Input.dispatchKeyEvent', {type, key, text: type === 'keyDown' ? text : undefined, windowsVirtualKeyCode: code});
  }

  /** The whole page as PNG bytes. */
  async screenshot() {
    const {data} = await this.#send('Page.captureScreenshot', {format: 'png', captureBeyondViewport: true});
    return Buffer.from(data, 'base64');
  }

  async close() {
    const ended = new Promise((resolve) => { this.process.on('exit', resolve); });
    delete this.session;
    this.#send('Browser.close').catch(() => {});  // ends its helper processes too, so that none writes into the profile any more
    const hung = setTimeout(() => this.process.kill('SIGKILL'), 5000);
    await ended;
    clearTimeout(hung);
    rmSync(this.profile, {recursive: true, force: true, maxRetries: 20, retryDelay: 100});
  }
}
