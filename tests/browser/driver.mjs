// Drives a browser. Every visit must log no error and request nothing from other hosts.

import { createRequire } from 'node:module';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const TIMEOUT_MS = 30_000;
// The browser can reach this machine only.
const FLAGS_OF_CHROMIUM = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
  '--hide-scrollbars', '--enable-unsafe-swiftshader', '--force-color-profile=srgb', '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost'];

// Firefox emulates no media features: light, with little motion, and a software renderer.
const PREFERENCES_OF_FIREFOX = { 'layout.css.prefers-color-scheme.content-override': 1, 'ui.prefersReducedMotion': 1, 'webgl.force-enabled': true };

// Loads puppeteer-core and axe-core from their folder.
export function tools(folder) {
  const require = createRequire(join(folder, 'node_modules', 'x.js'));
  return { puppeteer: require('puppeteer-core'), axe: require.resolve('axe-core/axe.min.js') };
}

// Counts checks that passed, and records the others with their scenario.
export class Findings {
  constructor() { this.passed = 0; this.failed = []; this.scenario = ''; }

  check(what, isTrue, actual = '') {
    if (isTrue) { this.passed += 1; return true; }
    this.failed.push(`${this.scenario}: ${what}${actual === '' ? '' : ` (actual: ${String(actual).slice(0, 400)})`}`);
    return false;
  }
}

export class Browser {
  // Starts Chromium, or Firefox if its executable has that name.
  static async start({ tools: folder, executable, flags = [] }) {
    const browser = new Browser();
    browser.tools = tools(folder);
    browser.isFirefox = basename(executable).startsWith('firefox');
    browser.profile = mkdtempSync(join(tmpdir(), 'pinswitch-browser-'));
    const options = browser.isFirefox ? { browser: 'firefox', extraPrefsFirefox: PREFERENCES_OF_FIREFOX } : { args: [...FLAGS_OF_CHROMIUM, ...flags] };
    browser.real = await browser.tools.puppeteer.launch({ executablePath: executable, headless: true, userDataDir: browser.profile, ...options });
    return browser;
  }

  async end() {
    await this.real.close();
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}

// One page, in its own context without the storage of other visits. `saves` is the folder of its downloads.
export class Visit {
  static async begin(browser, { width = 1440, height = 900, dark = false, findings, allowed = [], context, before, saves, showsAll = true }) {
    const visit = new Visit();
    Object.assign(visit, { browser, findings, allowed, problems: [], foreign: [] });
    visit.context = context ?? await browser.real.createBrowserContext(saves ? { downloadBehavior: { policy: 'allow', downloadPath: saves } } : {});
    visit.page = await visit.context.newPage();
    const { page } = visit;
    page.setDefaultTimeout(TIMEOUT_MS);
    page.on('console', (message) => { if (message.type() === 'error') visit.problems.push(message.text()); });
    page.on('pageerror', (error) => visit.problems.push(String(error?.stack ?? error)));
    page.on('request', (request) => visit.record(request.url()));
    await visit.look(width, height, dark);
    // As for a person who chose to see all parameters.
    if (showsAll) {
      await page.evaluateOnNewDocument(() => {
        try { if (!localStorage.getItem('pinswitch.configurator.1')) localStorage.setItem('pinswitch.configurator.1', JSON.stringify({ showsAll: true })); } catch { /* No storage. */ }
      });
    }
    if (before) await page.evaluateOnNewDocument(before);
    return visit;
  }

  // Records requests to other hosts.
  record(url) {
    const isOwn = ['blob:', 'data:', 'about:', 'file:'].some((scheme) => url.startsWith(scheme)) || url.startsWith(this.home ?? 'none');
    if (!isOwn) this.foreign.push(url);
  }

  async look(width, height, dark) {
    await this.page.setViewport({ width, height });
    if (!this.browser.isFirefox) await this.page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }, { name: 'prefers-reduced-motion', value: 'reduce' }]);
  }

  // Opens an address and waits for its design.
  async open(address, { settles = true } = {}) {
    this.home = address.startsWith('http') ? new URL(address).origin : 'file://';
    // A browser does not reload for a new fragment.
    if (this.page.url().split('#')[0] === address.split('#')[0]) await this.page.goto('about:blank');
    await this.page.goto(address);
    if (settles) await this.settled();
  }

  // Waits until the exact design for the present values is shown or refused.
  async settled() {
    await this.page.waitForFunction(() => document.body.dataset.ready === 'true' && document.body.dataset.pending === 'false');
  }

  async until(condition, ...given) {
    return this.page.waitForFunction(condition, {}, ...given).then(() => true, () => false);
  }

  async check(what, condition, ...given) {
    const isTrue = await this.until(condition, ...given);
    return this.findings.check(what, isTrue, isTrue ? '' : await this.page.evaluate(() => `${decodeURIComponent(location.hash)} ${document.querySelector('#notice').innerText} ${document.querySelector('#trouble').innerText}`));
  }

  // Whether the decoded address contains this text.
  async addressHas(part) {
    return this.check(`the address has ${part}`, (text) => decodeURIComponent(location.hash).includes(text), part);
  }
  async addressLacks(part) {
    return this.check(`the address has no ${part}`, (text) => !decodeURIComponent(location.hash).includes(text), part);
  }

  async text(selector) { return this.page.$eval(selector, (e) => e.textContent); }
  async shown(selector) { return this.page.$eval(selector, (e) => e.checkVisibility()); }
  // If an answer of the engine replaces the element before the click, the new one is clicked.
  async click(selector) {
    for (let attempt = 1; ; attempt += 1) {
      const element = await this.page.waitForSelector(selector, { visible: true });
      try {
        await element.click();
        return;
      } catch (problem) {
        if (attempt === 3 || !/detached|not clickable/.test(problem.message)) throw problem;
      }
    }
  }

  // Focuses an element; also works for elements of a drawing.
  async focus(selector) { await this.page.$eval(selector, (e) => e.focus()); }

  // Sets the value of a slider with its event.
  async slide(selector, value) {
    await this.page.$eval(selector, (e, to) => { e.value = to; e.dispatchEvent(new Event('input', { bubbles: true })); }, value);
  }

  async type(selector, value) {
    const element = await this.page.waitForSelector(selector, { visible: true });
    await element.evaluate((e) => { if (e.closest('details')) e.closest('details').open = true; e.scrollIntoView({ block: 'center' }); e.focus(); e.select(); });
    await this.page.keyboard.type(String(value));
    await element.evaluate((e) => e.dispatchEvent(new Event('change', { bubbles: true })));
  }

  // Drops a file on the page; `content` is text, or a number of bytes.
  async drop(name, content) {
    await this.page.evaluate((file, inside) => {
      const parts = typeof inside === 'number' ? [new Uint8Array(inside).fill(48)] : [inside];
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File(parts, file));
      for (const type of ['dragenter', 'dragover', 'drop']) document.body.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
    }, name, content);
  }

  // Returns a screenshot of an element, for comparison.
  async picture(selector) {
    // A change is drawn in the next frame, and the assembly may be drawn at low resolution first.
    await this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    await this.page.waitForFunction(() => (document.getElementById('view').dataset.drawn ?? 'finely') === 'finely');
    return (await this.page.$(selector)).screenshot({ encoding: 'base64' });
  }

  // Ends the visit; logged errors and requests to other hosts are failures, except those that the
  // scenario allows.
  async end({ keepsContext = false } = {}) {
    const errors = this.page.url().startsWith('about:') ? '0' : await this.page.evaluate(() => document.body.dataset.errors).catch(() => '0');
    const problems = this.problems.filter((text) => !this.allowed.some((pattern) => pattern.test(text)));
    this.findings.check('no error is logged', problems.length === 0, problems.join('; '));
    this.findings.check('no error is uncaught', errors === '0' || errors === undefined, errors);
    this.findings.check('no other host is requested', this.foreign.length === 0, this.foreign.join(' '));
    await this.page.close();
    if (!keepsContext) await this.context.close();
  }
}
