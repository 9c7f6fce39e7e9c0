// Prints size and speed of the page, the figures in cad/doc/configurator.md: node measure.mjs
// JOB.json, with the job of run.mjs, on an otherwise idle machine.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { brotliCompressSync, gzipSync } from 'node:zlib';
import { Browser, Findings, Visit } from './driver.mjs';
import { moduleSite, viewSite } from './sites.mjs';

const CHANGES = 200;
const MANY = 1000;
const job = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const scratch = mkdtempSync(join(tmpdir(), 'pinswitch-measure-'));

const kilo = (bytes) => `${Math.round(bytes / 1000)} kB`;
const quantile = (sorted, p) => sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))];

function printSize(folder) {
  const page = readFileSync(join(folder, 'index.html'));
  console.log(`page with module: ${kilo(page.length)} as a file, ${kilo(gzipSync(page, { level: 9 }).length)} by gzip, ${kilo(brotliCompressSync(page).length)} by brotli`);
}

// Time from opening the address to a design that is shown.
async function firstDisplay(browser, site) {
  const times = [];
  for (let i = 0; i < 5; i += 1) {
    const visit = await Visit.begin(browser, { findings: new Findings() });
    visit.home = site.origin;
    await visit.page.goto(`${site.address}#v=1&layout.pins=4,8,12`);
    await visit.page.waitForFunction(() => document.body.dataset.ready === 'true', { polling: 20 });
    times.push(await visit.page.evaluate(() => performance.now()));
    await visit.end();
  }
  console.log(`${site.name}: first display after ${times.map((t) => Math.round(t)).sort((a, b) => a - b).join(', ')} ms`);
}

// Random values of number fields, from a seeded generator, within 5 % of the default: most designs
// can be built.
function changes(facts, count) {
  let seed = 1;
  const random = () => { seed = (seed * 48271) % 2147483647; return seed / 2147483647; };
  const fields = facts.fields.filter((f) => f.kind === 'number' && f.default > 0);
  return Array.from({ length: count }, () => {
    const field = fields[Math.floor(random() * fields.length)];
    const [low, high] = field.ends ?? [0, Infinity];
    return [field.path, Number(Math.min(Math.max(field.default * (0.95 + 0.1 * random()), low), high).toFixed(3))];
  });
}

// Time in ms from a change of a slider until part and curve, or the refusal, are drawn; 5000
// without an answer, null if the value does not change.
async function timeOfChange(page, [path, value]) {
  return page.evaluate(async (field, to) => {
    const { dataset } = document.body;
    const input = document.getElementById(`f-${field.replace('.', '-')}`);
    if (Number(input.value) === to) return null;
    const before = dataset.requested;
    const start = performance.now();
    input.value = to;
    input.dispatchEvent(new Event('input', { bubbles: true }));
    if (dataset.requested === before) return null;
    // The exact answer to the change before may come first.
    while (dataset.answered !== dataset.requested) {
      if (performance.now() - start > 5000) return 5000;
      await new Promise((done) => { const { port1, port2 } = new MessageChannel(); port1.onmessage = () => { port1.close(); done(); }; port2.postMessage(0); });
    }
    // The answer is drawn in the next frame.
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    return performance.now() - start;
  }, path, value);
}

// Undoes a refused change.
async function undoRefused(page) {
  await page.evaluate(async () => {
    const isRefused = () => document.getElementById('trouble').textContent !== '';
    const end = performance.now() + 3000;
    if (isRefused()) document.getElementById('undo').click();
    while (isRefused() && performance.now() < end) await new Promise((done) => setTimeout(done, 10));
  });
}

async function speed(browser, site, facts) {
  const visit = await Visit.begin(browser, { findings: new Findings() });
  await visit.open(`${site.address}#v=1&layout.pins=4,8,12`);
  const times = [];
  for (const step of changes(facts, CHANGES)) {
    const time = await timeOfChange(visit.page, step);
    if (time !== null) times.push(time);
    await undoRefused(visit.page);
  }
  times.sort((a, b) => a - b);
  console.log(`${site.name}: ${times.length} random changes to part and curve: median ${Math.round(quantile(times, 0.5))} ms, 95th percentile ${Math.round(quantile(times, 0.95))} ms, worst ${Math.round(times.at(-1))} ms`);
  await visit.end();
}

async function memory(browser, site, facts) {
  const visit = await Visit.begin(browser, { findings: new Findings() });
  await visit.open(`${site.address}#v=1&layout.pins=4,8,12`);
  const session = await visit.page.createCDPSession();
  const used = async () => {
    await session.send('HeapProfiler.collectGarbage');
    const { usedSize } = await session.send('Runtime.getHeapUsage');
    const { nodes } = await session.send('Memory.getDOMCounters');
    const workers = await Promise.all(visit.page.workers().map((worker) => worker.evaluate(() => (typeof ready === 'undefined' || !ready ? 0 : ready.then((engine) => engine.memory.buffer.byteLength)))));
    return `${(usedSize / 1e6).toFixed(1)} MB of the page, ${workers.map((bytes) => `${(bytes / 1e6).toFixed(1)} MB`).join(' and ') || 'no module'}, ${nodes} nodes`;
  };
  console.log(`${site.name}: memory at first: ${await used()}`);
  for (const [i, step] of changes(facts, MANY).entries()) {
    await timeOfChange(visit.page, step);
    await undoRefused(visit.page);
    if ((i + 1) % 250 === 0) console.log(`${site.name}: memory after ${i + 1} changes: ${await used()}`);
  }
  await visit.end();
}

// Times of long requests: a search, all files, a calibration.
async function longRequests(browser, site, table) {
  const visit = await Visit.begin(browser, { findings: new Findings() });
  await visit.open(`${site.address}#v=1&layout.pins=4,8,12&targets.threshold_n=24`);
  const timed = async (what, act, done) => {
    const start = performance.now();
    await act();
    await visit.page.waitForFunction(done, { timeout: 600_000 });
    console.log(`${site.name}: ${what} ${((performance.now() - start) / 1000).toFixed(1)} s`);
  };
  await timed('a search takes', () => visit.click('#search'), () => document.querySelectorAll('.design').length > 0);
  await timed('all files take', () => visit.click('#download'), () => document.querySelectorAll('#file-list button').length > 0);
  await visit.click('#files-close');
  const rows = table.trim().split('\n').length - 1;
  await timed(`a calibration of ${rows} rows takes`, () => visit.drop('plateaus.csv', table), () => !document.querySelector('#use-model').hidden);
  await visit.end();
}

async function main() {
  writeFileSync(join(scratch, 'mine.toml'), '[layout]\npins = [5, 8, 11]\n');
  const sites = [await viewSite(job.binary, scratch, ['mine.toml'])];
  const { origin } = sites[0];
  const facts = await (await fetch(`${origin}/answer`, { method: 'POST', headers: { origin }, body: '{"command": "facts"}' })).json();
  if (job.site) { printSize(job.site); sites.push(await moduleSite(job.site)); }
  const browser = await Browser.start({ tools: job.tools, executable: job.browser });
  for (const site of sites.reverse()) {
    for (const [name, act] of Object.entries({ firstDisplay, speed, longRequests, memory })) {
      if (job.only && !job.only.split(' ').includes(name)) continue;
      await act(browser, site, name === 'longRequests' ? readFileSync(job.table, 'utf8') : facts);
    }
    await site.end();
  }
  await browser.end();
  rmSync(scratch, { recursive: true, force: true });
}

await main();
