// A person's measurements: kept through other files, undone, saved in a file and opened again.

import { mkdtempSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { Visit } from './driver.mjs';
import { START } from './design.mjs';

const SLOW_MS = 120_000;
const verdictOf = (visit) => visit.text('#verdict b');

// The text of the only file that a visit saved.
async function savedText(saves) {
  for (const until = Date.now() + 30_000; Date.now() < until;) {
    const [file] = readdirSync(saves).filter((name) => !/part$|crdownload$/.test(name));
    const text = file && readFileSync(join(saves, file), 'utf8');
    if (text) return { file, text };
    await new Promise((done) => { setTimeout(done, 50); });
  }
  return { file: 'nothing', text: '' };
}

export async function sessions(_, site, { table, findings, scratch }) {
  const saves = mkdtempSync(join(scratch, 'session-'));
  const visit = await Visit.begin(_.browser, { findings, saves });
  await visit.open(`${site.address}#v=1&layout.pins=5,8,11`);
  await visit.drop('mine.csv', table);
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  await visit.click('#use-model');
  await visit.type('#target-threshold', '24');
  await visit.settled();
  const friction = await visit.text('#friction-text');
  // A refused file takes nothing away.
  await visit.drop('junk.csv', 'hello,world\n');
  await visit.page.waitForSelector('#verdict .error');
  findings.check('another file keeps the fit', /^mine\.csv: /.test(await verdictOf(visit)) && await visit.shown('#fit'), await visit.text('#verdict'));
  // Removed, and undone.
  await visit.click('#remove-fit');
  await visit.check('measurements can be removed', () => document.querySelector('#fit').hidden && !/your readings/.test(document.querySelector('#legend').textContent));
  await visit.click('#undo');
  await visit.check('and come back', () => !document.querySelector('#fit').hidden && /^mine\.csv: /.test(document.querySelector('#verdict b').textContent));
  // Saved, and opened by someone else.
  await visit.click('#download');
  await visit.click('#session');
  const { file, text } = await savedText(saves);
  findings.check('the session is a file', file.endsWith('.json') && JSON.parse(text).schema === 'pinswitch.session/1', file);
  await visit.end();
  const other = await Visit.begin(_.browser, { findings });
  await other.open(site.address + START);
  await other.drop(file, text);
  await other.check('it opens elsewhere, with the verdict', () => /^mine\.csv: /.test(document.querySelector('#verdict b')?.textContent ?? ''));
  await other.settled();
  findings.check('with the calibrated curve', await other.text('#friction-text') === friction, await other.text('#friction-text'));
  findings.check('with the targets', await other.page.$eval('#target-threshold', (e) => e.value) === '24');
  findings.check('with residuals and points', await other.shown('.residuals') && /your readings/.test(await other.text('#legend')));
  await other.click('#undo');
  await other.check('one step undoes it', () => document.querySelector('#fit').hidden && document.querySelector('#target-threshold').value === '');
  for (const [name, content] of [['other.json', '{"schema": "other"}'], ['cut.json', text.slice(0, 200)], ['fit.json', JSON.stringify({ ...JSON.parse(text), fit: { file: 'x' } })], ['list.json', JSON.stringify({ ...JSON.parse(text), values: { 'layout.pins': '5,8,11' } })], ['wrong.json', JSON.stringify({ ...JSON.parse(text), targets: { threshold_n: -1, friction: [] } })]]) {
    await other.drop(name, content);
    await other.check(`${name} is refused`, (wanted) => document.querySelector('#notice').textContent.includes(`${wanted} was not saved by this page`), name);
  }
  await other.end();
}

// An interval without an upper end is kept for the next visit.
export async function unboundedInterval(_, site, { findings }) {
  const fit = { file: 'mine.csv', csv: null, model: 'm', head: 'mine.csv: a fit', lines: [], probabilities: [], sizes: [{ id: 'a', name: 'b', unit: 'N', value: 1, ci95: [0.5, null] }], points: [], residuals: [] };
  const visit = await Visit.begin(_.browser, { findings, before: `localStorage.setItem('pinswitch.configurator.1', JSON.stringify({ fit: ${JSON.stringify(fit)} }))`, showsAll: false });
  await visit.open(site.address + START);
  findings.check('a fit with an open interval stays', /0\.5 … ∞/.test(await visit.text('#fit')), await visit.text('#fit'));
  await visit.end();
}

// What was kept by hand or by another version does not stop the page.
export async function damagedMemory(_, site, { findings }) {
  for (const fit of [{ file: 'x', lines: [], probabilities: [null], sizes: [], points: [], residuals: [{}] }, { file: 'x', model: 'm', head: 'h', lines: [], probabilities: [], sizes: [{ id: 'a', name: 'b', unit: '', value: 1, ci95: 3 }], points: [], residuals: [] }, 7]) {
    const before = `localStorage.setItem('pinswitch.configurator.1', JSON.stringify({ fit: ${JSON.stringify(fit)} }))`;
    const visit = await Visit.begin(_.browser, { findings, before, showsAll: false });
    await visit.open(site.address + START);
    findings.check('a damaged fit is forgotten', !await visit.shown('#fit'));
    await visit.end();
  }
}
