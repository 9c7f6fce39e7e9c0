// Asking backwards, and measurements of one's own.

import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { START } from './design.mjs';

// A search or a calibration takes seconds, and more on a machine that does other things.
const SLOW_MS = 120_000;

export async function search(visit, site) {
  await visit.open(site.address + START);
  await visit.click('#search');
  await visit.check('a search without an ask says what to do', () => /Say first/.test(document.querySelector('#ask-says').textContent));
  // The mark on the plot is pulled, by hand and by key.
  await visit.page.$eval('.grip.threshold', (e) => e.scrollIntoView({ block: 'center' }));
  const grip = await (await visit.page.$('.grip.threshold')).boundingBox();
  const { mouse } = visit.page;
  await mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
  await mouse.down();
  await mouse.move(grip.x + 40, grip.y + 8, { steps: 3 });
  await mouse.up();
  await visit.addressHas('ask.threshold_n=');
  await visit.type('#ask-threshold', '24');
  await visit.addressHas('ask.threshold_n=24');
  const isOver = () => getComputedStyle(document.querySelector('.threshold-line.own')).zIndex > 0 && getComputedStyle(document.querySelector('.threshold-line.own'), '::after').backgroundColor !== 'rgba(0, 0, 0, 0)';
  visit.findings.check('where it switches now is not struck through by what is asked', await visit.page.evaluate(isOver));
  await visit.focus('.grip.diamond');
  await visit.page.keyboard.press('ArrowUp');
  await visit.addressHas('ask.friction=');
  await visit.click('#ask-frictions .tiny');
  await visit.addressLacks('ask.friction');
  await visit.click('#search');
  const told = await visit.page.evaluate(async () => {
    const texts = new Set();
    for (let i = 0; i < 35 && !document.querySelector('#stop').hidden; i += 1) {
      texts.add(document.querySelector('#search-says').textContent);
      await new Promise((done) => { setTimeout(done, 100); });
    }
    return [...texts].filter((text) => /Looking/.test(text));
  });
  visit.findings.check('the time of a search is not read aloud each second', told.length === 1, told.join(' / '));
  await visit.page.waitForSelector('#designs .design', { timeout: SLOW_MS });
  const cards = await visit.page.$$eval('.design', (all) => all.map((c) => Number(/(\d+) % likely/.exec(c.textContent)?.[1])));
  visit.findings.check('the best designs come as cards, the most probable first', cards.length > 1 && cards.every((p, i) => p >= 0 && p <= 100 && (i === 0 || p <= cards[i - 1])), cards);
  await visit.page.hover('.design:nth-child(2)');
  await visit.check('a card shows its curve', () => /design 2/.test(document.querySelector('#legend').textContent));
  const pins = await visit.page.$eval('.design:nth-child(2)', (card) => /pins \[([\d, ]+)\]/.exec(card.textContent)[1].replaceAll(' ', ''));
  await visit.click('.design:nth-child(2) button');
  await visit.settled();
  await visit.check('one click takes a design', (taken) => document.querySelector('#pins-say').textContent.replaceAll(' ', '') === `Pinsin${taken}`, pins);
  await visit.type('#ask-threshold', '24');
  await visit.click('#add-friction');
  await visit.type('#ask-frictions label:nth-child(2) input', '40');
  await visit.type('#ask-frictions label:nth-child(1) input', '8.5');
  await visit.addressHas('ask.friction=40:8.5');
  await visit.click('#search');
  await visit.page.waitForFunction(() => /asked: 8\.5 N/.test(document.querySelector('#designs').textContent), { timeout: SLOW_MS });
  const card = await visit.text('.design');
  visit.findings.check('a card answers each thing that was asked, and says the rest once', /switches at [\d.]+ N; asked: 24 N/.test(card) && /[\d.]+ N at 40 N of load; asked: 8\.5 N/.test(card) && card.split('heaviest').length === 2, card);
  visit.findings.check('what likely means is to be seen', await visit.shown('#likely-means') && /within 10 %/.test(await visit.text('#likely-means')), await visit.text('#likely-means'));
  await visit.click('#found-close');
  await visit.check('the cards go', () => document.querySelector('#found').hidden);
}

// The model that the command line fits to a table.
async function byCommandLine(binary, scratch, table) {
  const folder = mkdtempSync(join(scratch, 'fit-'));
  writeFileSync(join(folder, 'plateaus.csv'), table);
  await promisify(execFile)(binary, ['-q', 'calibrate', 'plateaus.csv', '--out', 'fit'], { cwd: folder });
  return readFileSync(join(folder, 'fit', 'model.toml'), 'utf8');
}

export async function calibration(visit, site, { table, binary, scratch }) {
  await visit.open(site.address + '#v=1&layout.pins=5,8,11');
  const published = await visit.text('#friction-words');
  await visit.drop('plateaus.csv', table);
  // While the model is fitted, the page stays its visitor's.
  await visit.focus('#apart');
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  const verdict = await visit.text('#verdict');
  visit.findings.check('a table gets a verdict', /^plateaus\.csv: the published model misses something/.test(verdict) && /Held-out error .* before/.test(verdict), verdict);
  visit.findings.check('it names what was found once, in words', verdict.split('coating_ploughing').length === 2 && /pins plough the coating/.test(verdict) && !/attributed/i.test(verdict), verdict);
  await visit.check('its curve stands beside the design', () => /with your model/.test(document.querySelector('#legend').textContent));
  await visit.click('#take-model');
  await visit.check('the model is in the design', (before) => /your model/.test(document.querySelector('#trust').textContent) && document.querySelector('#friction-words').textContent !== before, published);
  await visit.settled();
  await visit.addressHas('model=plateaus.csv~');
  // One of the page's own functions reads the model out of the address.
  const model = await visit.page.evaluate(async () => (await unpackModel(location.hash.split('model=')[1])).toml);
  visit.findings.check('the model is that of the command line, byte for byte', model === await byCommandLine(binary, scratch, table));
  const words = await visit.text('#friction-words');
  await visit.page.reload();
  await visit.settled();
  visit.findings.check('the address carries the model', await visit.text('#friction-words') === words);
  await visit.click('#drop-model');
  await visit.check('it can be given back', (before) => document.querySelector('#friction-words').textContent === before, published);
  await visit.settled();
}

// The page stays the visitor's: what takes long holds up no design.
async function designsMeanwhile(visit, what, pins) {
  await visit.page.evaluate((to) => { location.hash = `#v=1&layout.pins=${to}`; }, pins);
  const began = performance.now();
  await visit.check(`a design is answered beside ${what}`, (to) => document.querySelector('#pins-say').textContent.includes(to.replace(',', ', ')) && document.body.dataset.answered === document.body.dataset.asked, pins);
  const took = performance.now() - began;
  visit.findings.check(`and does not wait for ${what}`, took < 4000 && await visit.page.evaluate(() => ['#stop', '#stop-fit'].some((id) => !document.querySelector(id).hidden)), `${Math.round(took)} ms`);
}

// A fit that takes long is stopped, and what waited for it goes on.
export async function fitStopped(visit, site, { table }) {
  const [head, ...rows] = table.trim().split(/\r?\n/);
  const force = head.split(',').indexOf('force_N');
  // As many series again and again, none a copy of another.
  const again = (k) => rows.map((row) => row.split(',').map((cell, i) => (i === 0 ? `${k}-${cell}` : i === force ? (Number(cell) + 0.013 * k * Math.sin(Number(cell) * 1e4 + k)).toFixed(4) : cell)).join(','));
  const long = [head, ...Array.from({ length: 12 }, (_, k) => again(k)).flat()].join('\n');
  await visit.open(site.address + START);
  await visit.drop('long.csv', long);
  await visit.page.waitForSelector('#stop-fit:not([hidden])');
  await designsMeanwhile(visit, 'a fit', '5,9');
  // By key: the page still glides to where the verdict will stand.
  await visit.focus('#stop-fit');
  await visit.page.keyboard.press('Enter');
  await visit.check('a fit that was stopped says so', () => /Stopped/.test(document.querySelector('#verdict').textContent));
  await visit.check('and leaves nothing to stop', () => document.querySelector('#stop-fit').hidden);
  // A model that is dropped during a fit is taken at once, and what is dropped after it has the word.
  await visit.drop('long.csv', long);
  await visit.page.waitForSelector('#stop-fit:not([hidden])');
  await visit.drop('model.toml', 'schema = "pinswitch.model/1"\n');
  await visit.check('what is no model is told while a table is fitted', () => /model\.toml could not be opened/.test(document.querySelector('#notice').textContent));
  await visit.focus('#stop-fit');
  await visit.page.keyboard.press('Enter');
  await visit.click('#download');
  await visit.page.waitForSelector('#file-list button', { timeout: SLOW_MS });
}

// What no switch and no rig can give is refused, in the words of the command line, and offers no model.
export async function impossibleTables(visit, site, { table, binary, scratch }) {
  const [head, ...all] = table.trim().split(/\r?\n/);
  const columns = head.split(',');
  const rows = all.slice(0, 300).map((row) => row.split(','));
  const [direction, force, load] = ['direction', 'force_N', 'load_N'].map((name) => columns.indexOf(name));
  const changed = (change) => [head, ...rows.map((row) => change([...row]).join(','))].join('\n');
  const put = (row, column, value) => { row[column] = value; return row; };
  const tables = {
    'directions exchanged': changed((row) => put(row, direction, row[direction] === 'eccentric' ? 'concentric' : 'eccentric')),
    'forces in grams': changed((row) => put(row, force, (Number(row[force]) / 9.80665e-3).toFixed(2))),
    'forces of the wrong sign': changed((row) => put(row, force, -Number(row[force]))),
    'no forces': changed((row) => put(row, force, 0)),
    'loads in grams': changed((row) => put(row, load, (Number(row[load]) / 9.80665e-3).toFixed(2))),
  };
  await visit.open(site.address + START);
  for (const [what, csv] of Object.entries(tables)) {
    const folder = mkdtempSync(join(scratch, 'impossible-'));
    writeFileSync(join(folder, 'impossible.csv'), csv);
    const { code, stderr } = await promisify(execFile)(binary, ['-q', 'calibrate', 'impossible.csv', '--out', 'rig'], { cwd: folder }).catch((refused) => refused);
    visit.findings.check(`${what} are refused by the command line`, code === 2, stderr);
    await visit.drop('impossible.csv', csv);
    const said = stderr.replace(/^error: /, '').trim().slice(0, 60);
    await visit.check(`${what} are refused in its words`, (words) => document.querySelector('#verdict .error')?.textContent.includes(words), said);
    visit.findings.check(`${what} make no model`, !(await visit.shown('#take-model')));
  }
}
