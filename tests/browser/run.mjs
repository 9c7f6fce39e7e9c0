// Tests the configurator in a browser, with `pinswitch view` and with the module: node run.mjs
// JOB.json. The job has `binary` (pinswitch), `browser`, `tools` (a folder with puppeteer-core and
// axe-core), `table` (a table of plateaus), `pictures` (a folder for screenshots), optionally
// `site` (a folder that cad/app/build wrote), and optionally `only` (runs scenarios whose names
// contain one of its words). Exit code 1 if a check failed.

import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { Browser, Findings, Visit } from './driver.mjs';
import { moduleSite, viewSite } from './sites.mjs';
import * as appearance from './appearance.mjs';
import * as consistency from './consistency.mjs';
import * as design from './design.mjs';
import * as downloads from './downloads.mjs';
import * as embedding from './embedding.mjs';
import * as errors from './errors.mjs';
import * as focus from './focus.mjs';
import * as hands from './hands.mjs';
import * as report from './report.mjs';
import * as search from './search.mjs';
import * as server from './server.mjs';
import * as sessions from './sessions.mjs';
import * as tables from './tables.mjs';
import * as walks from './walks.mjs';

const job = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const scratch = mkdtempSync(join(tmpdir(), 'pinswitch-job-'));

// The page from a file, without a server.
async function fromFile(visit, site, { findings }) {
  if (!site.file) return;
  await visit.open(site.file + design.START);
  await visit.click('#mirror-pins');
  await visit.settled();
  findings.check('the page works from a file', (await visit.text('#friction-text')).includes('of load'));
  const packed = gzipSync(readFileSync(fileURLToPath(site.file)), { level: 9 }).length;
  findings.check('page and module have at most 1.75 MB with gzip', packed <= 1.75e6, `${packed} bytes`);
}

function scenarios() {
  const all = { fromFile, ...design, ...appearance, ...search, ...tables, ...errors, ...embedding, ...consistency, ...focus, ...hands, ...report, ...server, ...sessions, ...downloads, ...walks };
  return Object.entries(all).filter(([name, act]) => typeof act === 'function' && (job.only ?? '').split(' ').some((word) => name.includes(word)));
}

async function factsOf(site) {
  const { origin } = site;
  const response = await fetch(`${origin}/answer`, { method: 'POST', headers: { origin }, body: '{"command": "facts"}' });
  return response.json();
}

// Runs all scenarios with one engine, in one browser; returns their findings.
async function runScenarios(site, shared) {
  const findings = new Findings();
  const given = { ...shared, findings };
  const browser = await Browser.start({ tools: job.tools, executable: job.browser });
  browser.axeText = readFileSync(browser.tools.axe, 'utf8');
  for (const [name, act] of scenarios()) {
    findings.scenario = `${site.name}, ${name}`;
    const start = performance.now();
    const visit = await Visit.begin(browser, { findings });
    try {
      await act(visit, site, given);
    } catch (problem) {
      findings.check('the scenario ends without an exception', false, problem.stack);
    }
    await visit.end();
    console.log(`${findings.scenario}: ${((performance.now() - start) / 1000).toFixed(1)} s`);
  }
  await browser.end();
  return findings;
}

async function main() {
  mkdirSync(job.pictures, { recursive: true });
  const view = (name, text = '[layout]\npins = [5, 8, 11]\n') => {
    writeFileSync(join(scratch, name), text);
    return startView([name]);
  };
  const startView = (options) => viewSite(job.binary, scratch, options);
  const served = await view('mine.toml');
  const facts = await factsOf(served);
  const shared = { binary: job.binary, executable: job.browser, tools: job.tools, pictures: job.pictures, table: readFileSync(job.table, 'utf8'), facts, scratch, anotherView: view, startView };
  const sites = [served, ...(job.site ? [await moduleSite(job.site)] : [])];
  // In parallel: most of the time a scenario waits for its page.
  const findings = await Promise.all(sites.map((site) => runScenarios(site, shared)));
  await Promise.all(sites.map((site) => site.end()));
  rmSync(scratch, { recursive: true, force: true });
  const failed = findings.flatMap((one) => one.failed);
  const passed = findings.reduce((sum, one) => sum + one.passed, 0);
  for (const failure of failed) console.log(`FAILED ${failure}`);
  console.log(`${passed} passed, ${failed.length} failed`);
  return failed.length === 0 && passed > 0 ? 0 : 1;
}

process.exitCode = await main();
