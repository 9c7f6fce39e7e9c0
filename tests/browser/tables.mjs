// Tables of measurements and their models.

import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { START } from './design.mjs';

// A calibration takes seconds, and longer on a busy machine.
const SLOW_MS = 120_000;

// Returns the model that the command line fits to a table.
async function byCommandLine(binary, scratch, table) {
  const folder = mkdtempSync(join(scratch, 'fit-'));
  writeFileSync(join(folder, 'plateaus.csv'), table);
  await promisify(execFile)(binary, ['-q', 'calibrate', 'plateaus.csv', '--out', 'fit'], { cwd: folder });
  return readFileSync(join(folder, 'fit', 'model.toml'), 'utf8');
}

export async function calibration(visit, site, { table, binary, scratch }) {
  await visit.open(site.address + '#v=1&layout.pins=5,8,11');
  const published = await visit.text('#friction-text');
  await visit.drop('plateaus.csv', table);
  // The page can be used during the fit.
  await visit.focus('#explode');
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  const verdict = await visit.text('#verdict');
  visit.findings.check('a table gets a verdict', /^plateaus\.csv: the published model lacks an effect/.test(verdict) && /Held-out error: .* by the published model, .* by least squares/.test(verdict), verdict);
  visit.findings.check('it names the effect once, in words', verdict.split('coating_ploughing').length === 2 && /pins plough the coating/.test(verdict) && !/attributed/i.test(verdict), verdict);
  await visit.check('its curve is shown next to the design', () => /with your model/.test(document.querySelector('#legend').textContent));
  await visit.click('#use-model');
  await visit.check('the design uses the model', (before) => /your model/.test(document.querySelector('#trust').textContent) && document.querySelector('#friction-text').textContent !== before, published);
  await visit.settled();
  await visit.addressHas('model=plateaus.csv~');
  // A function of the page decodes the model in the address.
  const model = await visit.page.evaluate(async () => (await unpackModel(location.hash.split('model=')[1])).toml);
  const expected = await byCommandLine(binary, scratch, table);
  const other = expected.split('\n').find((line, i) => line !== model.split('\n')[i]);
  visit.findings.check('the model equals that of the command line, byte for byte', model === expected, other);
  const friction = await visit.text('#friction-text');
  await visit.page.reload();
  await visit.settled();
  visit.findings.check('the address contains the model', await visit.text('#friction-text') === friction);
  await visit.click('#remove-model');
  await visit.check('the model can be removed', (before) => document.querySelector('#friction-text').textContent === before, published);
  await visit.settled();
}

// Without a table: an example, its verdict, and what to measure next.
export async function exampleAndNextRuns(visit, site) {
  await visit.open(site.address + START);
  await visit.click('#sample-table');
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  visit.findings.check('the example has its effect', /pins plough the coating/.test(await visit.text('#verdict')), await visit.text('#verdict'));
  await visit.type('#next-minutes', '-3');
  await visit.click('#plan-runs');
  await visit.page.waitForSelector('#next-plan .error', { timeout: SLOW_MS });
  visit.findings.check('an impossible time is refused', /at most 2400 minutes/.test(await visit.text('#next-plan')), await visit.text('#next-plan'));
  await visit.type('#next-minutes', '20,5');
  await visit.click('#plan-runs');
  await visit.page.waitForSelector('#next-plan li', { timeout: SLOW_MS });
  const text = await visit.text('#next-plan');
  const [, runs, minutes] = /(\d+) runs in (\d+) minutes/.exec(text) ?? [];
  visit.findings.check('runs within the time are planned', runs > 3 && minutes <= 21, text);
  await visit.page.evaluate(() => { HTMLAnchorElement.prototype.click = function click() { window.saved = this.download; }; });
  await visit.page.$$eval('#next-plan button', (all) => all.forEach((e) => e.click()));
  await visit.check('the run sheet can be saved', () => window.saved === 'run-sheet.html');
  visit.findings.check('the runs are on the page', (await visit.page.$$('#next-plan tbody tr')).length === Number(runs));
  await visit.type('#next-minutes', '0,5 h');
  await visit.click('#plan-runs');
  await visit.check('minutes can be typed as hours', () => /(2\d|30) minutes/.test(document.querySelector('#next-plan').textContent));
  await visit.click('#remove-fit');
  visit.findings.check('without the table there is no such plan', !await visit.shown('#next'));
}

// A model knows nothing about what its tendon never touched, so it is not offered for such a switch.
export async function modelOfAnotherMaterial(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.drop('abs.csv', table.split('\n').filter((line) => !line.includes(',silicone,')).join('\n'));
  await visit.check('it is said why', () => /no reading of the fitted table is on silicone/.test(document.querySelector('#model-error').textContent));
  visit.findings.check('the model is not offered', await visit.page.$eval('#use-model', (e) => e.hidden));
}

// The file of a laboratory is shown before it is used, and its questions are answered on the page.
export async function laboratoryFile(visit, site) {
  await visit.open(site.address + START);
  const rows = [0.5, 1, 2, 3.5, 5, 8].flatMap((kg) => [0, 1, 2].map((i) => [1.2, 1 / 1.2].map((factor) => kg * 9.80665 * factor + 0.013 * ((i * 7 + kg * 3) % 5)).map((n) => n.toFixed(3).replace('.', ',')).join(';')).map((forces) => `${String(kg).replace('.', ',')};${forces}`));
  await visit.drop('versuch.csv', ['Last [kg];F_heben [N];F_senken [N]', ...rows].join('\r\n'));
  await visit.check('what was understood is shown', () => /x 1000 -> g/.test(document.querySelector('.understood')?.textContent ?? ''));
  await visit.click('#use-table');
  await visit.check('the table gets a verdict', () => /versuch\.csv: the/.test(document.querySelector('#verdict b')?.textContent ?? '') && /friction exponent = 0\.18/.test(document.querySelector('#verdict').textContent));
  await visit.check('a rig without a switch has no model of a part', () => document.querySelector('#use-model').hidden);
  // Friction may be the pull, or the pull minus the load.
  await visit.drop('reibung.csv', 'load (N),friction (N),direction\n5,0.5,pull\n10,0.9,pull\n5,0.5,release\n10,0.9,release\n');
  await visit.check('a column of friction is no force', () => /no column is the force/.test(document.querySelector('#verdict .error')?.textContent ?? ''));
  // A plateau table of a program with a row of units.
  await visit.drop('units.csv', 'series,substrate,pins,load_N,direction,force_N\n-,-,-,N,-,N\na,plain,,10,concentric,12\na,plain,,10,eccentric,8\n');
  await visit.check('a row of units is understood', () => /units row/.test(document.querySelector('.understood')?.textContent ?? ''));
  // A number with two readings.
  await visit.drop('kraft.csv', 'Last [N];F_heben [N];F_senken [N]\n1,500;2,500;1,200\n2,500;4,500;2,100\n');
  await visit.check('a question is asked', () => document.querySelectorAll('#verdict .row button').length > 1);
  await visit.page.evaluate(() => document.querySelector('#verdict .row button').click());
  await visit.check('an answer closes it', () => document.querySelector('#use-table') !== null);
}

// Long requests do not delay designs.
async function designsDuring(visit, what, pins) {
  await visit.page.evaluate((to) => { location.hash = `#v=1&layout.pins=${to}`; }, pins);
  const start = performance.now();
  await visit.check(`a design is answered during ${what}`, (to) => document.querySelector('#pins-title').textContent.includes(to.replace(',', ', ')) && document.body.dataset.answered === document.body.dataset.requested, pins);
  const duration = performance.now() - start;
  visit.findings.check(`it does not wait for ${what}`, duration < 4000 && await visit.page.evaluate(() => ['#stop', '#stop-fit'].some((id) => !document.querySelector(id).hidden)), `${Math.round(duration)} ms`);
}

// A long fit is stopped, and requests that waited for it continue.
export async function stoppedFit(visit, site, { table }) {
  const [head, ...rows] = table.trim().split(/\r?\n/);
  const force = head.split(',').indexOf('force_N');
  // The same series several times, with other noise.
  const copy = (k) => rows.map((row) => row.split(',').map((cell, i) => (i === 0 ? `${k}-${cell}` : i === force ? (Number(cell) + 0.013 * k * Math.sin(Number(cell) * 1e4 + k)).toFixed(4) : cell)).join(','));
  const long = [head, ...Array.from({ length: 12 }, (_, k) => copy(k)).flat()].join('\n');
  await visit.open(site.address + START);
  await visit.drop('long.csv', long);
  await visit.page.waitForSelector('#stop-fit:not([hidden])');
  await designsDuring(visit, 'a fit', '5,9');
  // By key, since the page still scrolls to the verdict.
  await visit.focus('#stop-fit');
  await visit.page.keyboard.press('Enter');
  await visit.check('a stopped fit is reported', () => /Stopped/.test(document.querySelector('#verdict').textContent));
  await visit.check('its Stop button is hidden', () => document.querySelector('#stop-fit').hidden);
  // A model that is dropped during a fit is opened at once.
  await visit.drop('long.csv', long);
  await visit.page.waitForSelector('#stop-fit:not([hidden])');
  await visit.drop('model.toml', 'schema = "pinswitch.model/1"\n');
  await visit.check('an invalid model is reported during a fit', () => /Cannot open model\.toml/.test(document.querySelector('#notice').textContent));
  await visit.focus('#stop-fit');
  await visit.page.keyboard.press('Enter');
  await visit.click('#download');
  await visit.page.waitForSelector('#file-list button', { timeout: SLOW_MS });
}

// Implausible tables are refused with the text of the command line, and give no model.
export async function implausibleTables(visit, site, { table, binary, scratch }) {
  const [head, ...all] = table.trim().split(/\r?\n/);
  const columns = head.split(',');
  const rows = all.slice(0, 300).map((row) => row.split(','));
  const [direction, force, load] = ['direction', 'force_N', 'load_N'].map((name) => columns.indexOf(name));
  const changed = (change) => [head, ...rows.map((row) => change([...row]).join(','))].join('\n');
  const set = (row, column, value) => { row[column] = value; return row; };
  const tables = {
    'directions exchanged': changed((row) => set(row, direction, row[direction] === 'eccentric' ? 'concentric' : 'eccentric')),
    'forces in grams': changed((row) => set(row, force, (Number(row[force]) / 9.80665e-3).toFixed(2))),
    'forces of the wrong sign': changed((row) => set(row, force, -Number(row[force]))),
    'no forces': changed((row) => set(row, force, 0)),
    'loads in grams': changed((row) => set(row, load, (Number(row[load]) / 9.80665e-3).toFixed(2))),
  };
  await visit.open(site.address + START);
  for (const [what, csv] of Object.entries(tables)) {
    const folder = mkdtempSync(join(scratch, 'implausible-'));
    writeFileSync(join(folder, 'implausible.csv'), csv);
    const { code, stderr } = await promisify(execFile)(binary, ['-q', 'calibrate', 'implausible.csv', '--out', 'rig'], { cwd: folder }).catch((failure) => failure);
    visit.findings.check(`${what} are refused by the command line`, code === 2, stderr);
    await visit.drop('implausible.csv', csv);
    const message = stderr.replace(/^error: /, '').trim().split('\n')[0].slice(0, 60);
    await visit.check(`${what} are refused with the same text`, (text) => document.querySelector('#verdict .error')?.textContent.includes(text), message);
    visit.findings.check(`${what} give no model`, !(await visit.shown('#use-model')));
  }
}
