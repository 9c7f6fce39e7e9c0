// Drives the configurator in a real browser, with `pinswitch view` and with the module: node run.mjs JOB.json, where the job
// names `binary` (pinswitch), `browser`, `tools` (a folder with puppeteer-core and axe-core), `table` (a table of plateaus),
// `pictures` (a folder for screenshots) and, where there is one, `site` (the folder that cad/app/build made). Exit code 1
// if anything did not hold; `only` runs the scenarios whose names hold one of its words.

import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { Browser, Findings, Visit } from './drive.mjs';
import { moduleSite, viewSite } from './engines.mjs';
import * as around from './around.mjs';
import * as belongs from './belongs.mjs';
import * as design from './design.mjs';
import * as downloads from './downloads.mjs';
import * as focus from './focus.mjs';
import * as look from './look.mjs';
import * as served from './served.mjs';
import * as tables from './tables.mjs';
import * as trouble from './trouble.mjs';

const job = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const scratch = mkdtempSync(join(tmpdir(), 'pinswitch-job-'));

// A page that a double click opened: from a file, without any server.
async function fromFile(visit, site, { findings }) {
  if (!site.file) return;
  await visit.open(site.file + design.START);
  await visit.click('#mirror-pins');
  await visit.settled();
  findings.check('a file that was opened by a double click works', (await visit.text('#friction-words')).includes('of load'));
  const sent = gzipSync(readFileSync(fileURLToPath(site.file)), { level: 9 }).length;
  findings.check('page and module weigh at most 1.2 MB as a server sends them', sent <= 1.2e6, `${sent} bytes`);
}

function scenarios() {
  const all = { fromFile, ...design, ...look, ...tables, ...trouble, ...around, ...belongs, ...focus, ...served, ...downloads };
  return Object.entries(all).filter(([name, act]) => typeof act === 'function' && (job.only ?? '').split(' ').some((word) => name.includes(word)));
}

async function factsOf(site) {
  const { origin } = site;
  const response = await fetch(`${origin}/answer`, { method: 'POST', headers: { origin }, body: '{"ask": "facts"}' });
  return response.json();
}

// All scenarios with one engine, in a browser of their own; what they found.
async function drive(site, shared) {
  const findings = new Findings();
  const given = { ...shared, findings };
  const browser = await Browser.start({ tools: job.tools, executable: job.browser });
  browser.axeText = readFileSync(browser.tools.axe, 'utf8');
  for (const [name, act] of scenarios()) {
    findings.scenario = `${site.name}, ${name}`;
    const began = performance.now();
    const visit = await Visit.begin(browser, { findings });
    try {
      await act(visit, site, given);
    } catch (problem) {
      findings.check('it came to its end', false, problem.stack);
    }
    await visit.end();
    console.log(`${findings.scenario}: ${((performance.now() - began) / 1000).toFixed(1)} s`);
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
  const startView = (given) => viewSite(job.binary, scratch, given);
  const server = await view('mine.toml');
  const facts = await factsOf(server);
  const shared = { binary: job.binary, executable: job.browser, tools: job.tools, pictures: job.pictures, table: readFileSync(job.table, 'utf8'), facts, scratch, anotherView: view, startView };
  const sites = [server, ...(job.site ? [await moduleSite(job.site)] : [])];
  // Pages wait for their visitors most of the time: both engines are tried at once.
  const findings = await Promise.all(sites.map((site) => drive(site, shared)));
  await Promise.all(sites.map((site) => site.end()));
  rmSync(scratch, { recursive: true, force: true });
  const failed = findings.flatMap((found) => found.failed);
  const held = findings.reduce((sum, found) => sum + found.held, 0);
  for (const failure of failed) console.log(`FAILED ${failure}`);
  console.log(`${held} held, ${failed.length} failed`);
  return failed.length === 0 && held > 0 ? 0 : 1;
}

process.exitCode = await main();
