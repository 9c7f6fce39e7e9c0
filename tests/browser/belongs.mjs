// What the page shows belongs to the design that it shows: nothing of an earlier design, ask, model or file stands beside
// it as if it were its own. Each of these once did.

import { readFileSync, writeFileSync } from 'node:fs';
import { START } from './design.mjs';

const SLOW_MS = 120_000;
const legendHas = (words) => document.querySelector('#legend').textContent.includes(words);
const legendLacks = (words) => !document.querySelector('#legend').textContent.includes(words);

async function searched(visit) {
  await visit.click('#search');
  await visit.page.waitForFunction(() => document.querySelectorAll('.design').length > 0 && document.querySelector('#stop').hidden, { timeout: SLOW_MS });
}

export async function curveOfAModelNotTaken(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  await visit.check('the curve by the model stands beside that of the design', legendHas, 'with your model');
  const gone = visit.page.evaluate(() => new Promise((done) => {
    new MutationObserver(() => { if (!document.querySelector('#legend').textContent.includes('with your model')) done(true); }).observe(document.querySelector('#legend'), { childList: true });
    setTimeout(() => done(false), 5000);
  }));
  await visit.click('#clear-pins');
  visit.findings.check('it goes with the design that it was of', await gone);
  await visit.check('and comes back for the new one', legendHas, 'with your model');
  await visit.click('#take-model');
  await visit.check('taken, it is the curve of the design', legendLacks, 'with your model');
  await visit.settled();
}

// One table's verdict, button and curve are not another's.
export async function tableAfterATable(visit, site, { table }) {
  await visit.open(site.address + START);
  const isBare = () => document.querySelector('#take-model').hidden && !document.querySelector('#legend').textContent.includes('with your model');
  await visit.drop('first.csv', table);
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  await visit.check('its curve is drawn', legendHas, 'with your model');
  visit.findings.check('a verdict names its file', (await visit.text('#verdict')).startsWith('first.csv: '), await visit.text('#verdict'));
  await visit.drop('second.csv', 'a,b\n1,2\n');
  await visit.check('a table that cannot be read is told', () => /second\.csv/.test(document.querySelector('#verdict .error')?.textContent ?? ''));
  visit.findings.check('nothing of the first stands beside it', await visit.page.evaluate(isBare));
  await visit.drop('third.csv', table);
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  await visit.drop('fourth.csv', table);
  await visit.check('nothing of the third stands there while the fourth is fitted', () => /Fitting the model to fourth\.csv/.test(document.querySelector('#verdict').textContent));
  visit.findings.check('no button offers its model', await visit.page.evaluate(isBare));
  await visit.drop('fifth.csv', 'a,b\n1,2\n');
  await visit.page.waitForSelector('#verdict .error', { timeout: SLOW_MS });
  await new Promise((done) => { setTimeout(done, 1500); });
  visit.findings.check('the last table has the word, whatever was still being fitted', /fifth\.csv/.test(await visit.text('#verdict')), await visit.text('#verdict'));
}

export async function searchByTheModel(visit, site, { table }) {
  await visit.open(`${site.address}${START}&ask.threshold_n=14`);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  await visit.click('#take-model');
  await visit.settled();
  await searched(visit);
  await visit.check('a search says by which model it was made', () => /by the model from plateaus\.csv/.test(document.querySelector('#search-says').textContent));
  const words = await visit.page.$eval('.design', (card) => card.textContent);
  const [, pins, friction] = /pins \[([\d, ]+)\].*?([\d.]+) N at the heaviest load/.exec(words);
  await visit.click('.design button');
  await visit.addressHas(`layout.pins=${pins.replaceAll(' ', '')}`);
  await visit.settled();
  await visit.slide('#load', 1e9);
  const shown = Number.parseFloat(await visit.text('#friction-now'));
  visit.findings.check('what a card promised is what the design shows', Math.abs(shown - Number(friction)) < 0.06, `${friction} and ${shown}`);
}

export async function cardsOfAnEarlierDesign(visit, site) {
  await visit.open(`${site.address}${START}&ask.threshold_n=24`);
  await searched(visit);
  visit.findings.check('cards that were just found are of this design', !(await visit.page.$('.found.old')));
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.check('cards of an earlier design say so', () => document.querySelector('.found.old') && /before your last change/.test(document.querySelector('#search-says').textContent));
  await visit.click('.design button');
  await visit.addressHas('silicone.thickness_mm=3');
  await visit.click('#undo');
  await visit.click('#undo');
  await visit.check('with the change undone they are of this one again', () => !document.querySelector('.found.old'));
  await visit.settled();
}

export async function closingCardsEndsASearchOnly(visit, site, { table }) {
  await visit.open(`${site.address}${START}&ask.threshold_n=24`);
  await searched(visit);
  await visit.drop('plateaus.csv', table);
  await visit.click('#found-close');
  const verdict = await visit.page.waitForSelector('#verdict b', { timeout: SLOW_MS }).then(() => true, () => false);
  visit.findings.check('a table is fitted to its end while cards are closed', verdict, await visit.text('#verdict'));
  await visit.settled();
}

export async function filesBehindASearch(visit, site) {
  await visit.open(`${site.address}${START}&ask.threshold_n=24`);
  await visit.click('#search');
  await visit.click('#download');
  await visit.check('files that wait for a search say so', () => /Waits for the search for designs/.test(document.querySelector('#files-say').textContent));
  await visit.page.waitForSelector('#file-list li', { timeout: SLOW_MS });
  visit.findings.check('and no longer once they are there', await visit.text('#files-say') === '', await visit.text('#files-say'));
  await visit.click('#files-close');
  await visit.settled();
}

export async function textThatIsNoValue(visit, site) {
  await visit.open(site.address + START);
  const box = '#f-silicone-thickness_mm';
  const isGood = (selector) => document.querySelector(selector).value === '2' && !document.querySelector(selector).hasAttribute('aria-invalid');
  await visit.focus(box);
  await visit.page.keyboard.press('Home');
  for (let i = 0; i < 4; i += 1) await visit.page.keyboard.press('Delete');
  await visit.check('an empty box is told', (selector) => document.querySelector(selector).getAttribute('aria-invalid') === 'true', box);
  await visit.focus('#apart');
  await visit.check('left, it shows what the design has', isGood, box);
  await visit.type('#f-segment-grooves', '17.5');
  await visit.focus('#apart');
  await visit.check('a number that is not whole goes, too', () => document.querySelector('#f-segment-grooves').value === '17' && !document.querySelector('#f-segment-grooves').hasAttribute('aria-invalid'));
  await visit.type('#f-segment-grooves', '7');
  await visit.check('grooves too few for the pins are refused', () => document.body.classList.contains('stale'));
  await visit.click('#mirror-pins');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.type('#f-segment-grooves', '15');
  await visit.settled();
  await visit.click('#add-friction');
  await visit.addressHas('ask.friction=');
  await visit.type('#ask-frictions input', '-3');
  await visit.check('what cannot be asked is told', () => /above 0/.test(document.querySelector('#ask-says').textContent));
  const asked = await visit.page.evaluate(() => /ask\.friction=[\d.]+:([\d.]+)/.exec(decodeURIComponent(location.hash))[1]);
  await visit.focus('#apart');
  await visit.check('left, the box shows what is asked', (value) => Number(document.querySelector('#ask-frictions input').value) === Number(value) && document.querySelector('#ask-says').hidden, asked);
  await visit.type('#ask-threshold', '1e9');
  await visit.addressLacks('ask.threshold_n=1000000000');
  await visit.settled();
}

export async function keptCurveOfARefusedDesign(visit, site) {
  await visit.open(site.address + START);
  await visit.type('#f-layout-pins', '5, 6, 7, 99');
  await visit.check('the design is refused', () => document.body.classList.contains('stale'));
  await visit.click('#keep');
  await visit.check('what is kept is what is seen', legendHas, '[4, 8, 12]');
  visit.findings.check('and not what was refused', !(await visit.text('#legend')).includes('99'));
}

export async function printerUnderTheDesign(visit, site, { facts }) {
  const printers = facts.templates.filter((t) => t.kind === 'printer' && t.values['print.bed_mm'] !== undefined);
  await visit.open(`${site.address}${START}&print.bed_mm=151`);
  const choose = async (name) => {
    await visit.page.$eval('#more', (menu) => { menu.open = true; });
    await (await visit.page.evaluateHandle((n) => [...document.querySelectorAll('#template-list button')].find((b) => b.firstChild.textContent === n), name)).click();
    await visit.settled();
  };
  await choose(printers[0].name);
  await visit.addressHas('print.bed_mm=151');
  await visit.check('a value that stays is told', () => /stays: .*side of the bed/.test(document.querySelector('#said').textContent));
  const others = facts.templates.filter((t) => t.kind === 'printer');
  const [first, second] = others;
  await visit.open(site.address + START);
  await choose(first.name);
  await choose(second.name);
  const values = await visit.page.evaluate(() => decodeURIComponent(location.hash));
  const wanted = Object.entries(second.values).filter(([path]) => path in first.values).map(([path, value]) => `${path}=${value}`);
  visit.findings.check('one printer takes the place of another', wanted.every((pair) => values.includes(pair) || pair.includes('true') || pair.includes('false')) || wanted.length === 0, `${values} lacks one of ${wanted}`);
}

export async function filesUnderTheDialog(visit, site) {
  await visit.open(`${site.address}${START}&parts.proxy=false`);
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.settled();
  await visit.click('#download');
  await visit.page.waitForSelector('#file-list li', { timeout: SLOW_MS });
  await visit.page.keyboard.down('Control');
  await visit.page.keyboard.press('z');
  await visit.page.keyboard.up('Control');
  await visit.addressHas('silicone.thickness_mm=3');
  await visit.click('#files-close');
  await visit.settled();
}

export async function modelThatIsNone(visit, site) {
  await visit.open(site.address + START);
  await visit.drop('model.toml', 'schema = "pinswitch.model/1"\nname = "x"\n');
  await visit.check('a model that is none is refused', () => /model\.toml could not be opened/.test(document.querySelector('#notice').textContent));
  await visit.addressLacks('model=');
  await visit.settled();
}

export async function nameOfAnOpenedFile(visit, site) {
  await visit.open(site.address + START);
  await visit.drop('My Part.toml', '[layout]\npins = [7]\n');
  await visit.addressHas('switch.name=My Part');
  await visit.check('a file lends its name', () => document.querySelector('#name').textContent === 'My Part');
  await visit.settled();
}

export async function longName(visit, site) {
  const name = 'n'.repeat(80);
  for (const width of [375, 1440]) {
    await visit.look(width, 900, false);
    await visit.open(`${site.address}${START}&switch.name=${name}`);
    const fits = await visit.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.querySelector('#name').getBoundingClientRect().right <= document.querySelector('.stage').getBoundingClientRect().right);
    visit.findings.check(`a long name fits at ${width} px`, fits);
  }
}

// A file that was changed while the page looked elsewhere is not written over without a question.
export async function fileThatChangedMeanwhile(visit, site, { anotherView, facts }) {
  if (site.file) return;
  const own = await anotherView('meanwhile.toml', '[layout]\npins = [3, 8, 13]\n[silicone]\nthickness_mm = 3.0\n');
  const grooves = facts.fields.find((f) => f.path === 'segment.grooves').default;
  try {
    // An address of before, with another design.
    await visit.open(own.address + START);
    await visit.type('#f-silicone-hardness_shore_a', '40');
    await visit.settled();
    await visit.click('#save');
    await visit.check('it does not save over them', () => /was not saved.*pins in/s.test(document.querySelector('#notice').textContent));
    const before = readFileSync(own.followed, 'utf8');
    visit.findings.check('the file is as it was', before.includes('[3, 8, 13]') && before.includes('3.0'), before);
    await (await visit.page.evaluateHandle(() => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === 'Save over it'))).click();
    await visit.check('asked for, it does', () => /Saved to meanwhile\.toml/.test(document.querySelector('#said').textContent));
    visit.findings.check('the file has the values of the page', readFileSync(own.followed, 'utf8').includes('[4, 8, 12]'));
    writeFileSync(own.followed, '[layout]\npins = [5, 9]\n');
    await visit.addressHas('layout.pins=5,9');
    await visit.settled();
    await visit.focus(`[data-groove="${grooves}"]`);
    await visit.page.keyboard.press('Space');
    await visit.settled();
    await visit.click('#save');
    await visit.check('a file that was followed is saved at once', () => /Saved to meanwhile\.toml/.test(document.querySelector('#said').textContent) && document.querySelector('#notice').hidden);
    visit.findings.check('with what was added', readFileSync(own.followed, 'utf8').includes(`[5, 9, ${grooves}]`), readFileSync(own.followed, 'utf8'));
    await visit.page.reload();
    await visit.settled();
    visit.findings.check('a page that is loaded again knows the file', await visit.page.$eval('#notice', (e) => e.hidden));
    const address = await visit.page.evaluate(() => location.hash);
    await visit.page.goto('about:blank');
    writeFileSync(own.followed, '[layout]\npins = [6, 10]\n');
    await new Promise((done) => setTimeout(done, 1500));
    await visit.open(own.address + address);
    await visit.check('a page that comes back to another file says so', () => /meanwhile\.toml has other values/.test(document.querySelector('#notice').textContent));
  } finally {
    await visit.page.goto('about:blank');
    await own.end();
  }
}
