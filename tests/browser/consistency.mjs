// Everything that the page shows belongs to the present design, and not to an earlier design,
// target, model or file. Each scenario is a former defect.

import { readFileSync, writeFileSync } from 'node:fs';
import { START } from './design.mjs';

const SLOW_MS = 120_000;
const legendHas = (words) => document.querySelector('#legend').textContent.includes(words);
const legendLacks = (words) => !document.querySelector('#legend').textContent.includes(words);

async function searched(visit) {
  await visit.click('#search');
  await visit.page.waitForFunction(() => document.querySelectorAll('.design').length > 0 && document.querySelector('#stop').hidden, { timeout: SLOW_MS });
}

export async function curveOfAnUnusedModel(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  await visit.check('the curve by the model is shown next to the present one', legendHas, 'with your model');
  const isRemoved = visit.page.evaluate(() => new Promise((done) => {
    new MutationObserver(() => { if (!document.querySelector('#legend').textContent.includes('with your model')) done(true); }).observe(document.querySelector('#legend'), { childList: true });
    setTimeout(() => done(false), 5000);
  }));
  await visit.click('#clear-pins');
  visit.findings.check('a change of the design removes it', await isRemoved);
  await visit.check('it is shown again for the new design', legendHas, 'with your model');
  await visit.click('#use-model');
  await visit.check('once used, it is the curve of the design', legendLacks, 'with your model');
  await visit.settled();
}

// Verdict, button and curve belong to the last table.
export async function secondTable(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.drop('first.csv', table);
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  await visit.check('its curve is drawn', legendHas, 'with your model');
  visit.findings.check('a verdict names its file', (await visit.text('#verdict')).startsWith('first.csv: '), await visit.text('#verdict'));
  await visit.drop('second.csv', 'a,b\n1,2\n');
  await visit.check('an unreadable table is reported', () => /second\.csv/.test(document.querySelector('#verdict .error')?.textContent ?? ''));
  visit.findings.check('the fit of the first table stays', /first\.csv: the/.test(await visit.text('#verdict')) && await visit.shown('#use-model'), await visit.text('#verdict'));
  await visit.drop('third.csv', table);
  await visit.page.waitForFunction(() => document.querySelector('#verdict b')?.textContent.startsWith('third.csv: '), { timeout: SLOW_MS });
  await visit.click('#use-model');
  await visit.settled();
  await visit.drop('fourth.csv', `${table.trim()}\n`.replaceAll(/,([\d.]+)\n/g, (_, force) => `,${(1.01 * Number(force)).toFixed(4)}\n`));
  await visit.check('the fit of the fourth is reported, above the third', () => /Fitting the model to fourth\.csv.*third\.csv: /.test(document.querySelector('#verdict').textContent));
  await visit.page.waitForFunction(() => document.querySelector('#verdict b')?.textContent.startsWith('fourth.csv: '), { timeout: SLOW_MS });
  await visit.check('its model can replace the one in use', () => /Use the model of fourth\.csv instead/.test(document.querySelector('#use-model:not([hidden])')?.textContent ?? ''));
  await visit.drop('fifth.csv', 'a,b\n1,2\n');
  await visit.page.waitForSelector('#verdict .error', { timeout: SLOW_MS });
  await new Promise((done) => { setTimeout(done, 1500); });
  visit.findings.check('the message is about the last table', /fifth\.csv/.test(await visit.text('#verdict')), await visit.text('#verdict'));
}

export async function searchWithAModel(visit, site, { table }) {
  await visit.open(`${site.address}${START}&targets.threshold_n=14`);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  await visit.click('#use-model');
  await visit.settled();
  await searched(visit);
  await visit.check('a search names its model', () => /with the model from plateaus\.csv/.test(document.querySelector('#search-status').textContent));
  const words = await visit.page.$eval('.design', (card) => card.textContent);
  const [, pins, friction] = /pins \[([\d, ]+)\].*?([\d.]+) N at the heaviest load/.exec(words);
  await visit.click('.design button');
  await visit.addressHas(`layout.pins=${pins.replaceAll(' ', '')}`);
  await visit.settled();
  await visit.slide('#load', 1e9);
  const shown = Number.parseFloat(await visit.text('#friction-now'));
  visit.findings.check('the design has the friction of its card', Math.abs(shown - Number(friction)) < 0.06, `${friction} and ${shown}`);
}

export async function cardsOfAnEarlierDesign(visit, site) {
  await visit.open(`${site.address}${START}&targets.threshold_n=24`);
  await searched(visit);
  visit.findings.check('new cards belong to the present design', !(await visit.page.$('.results.outdated')));
  await visit.type('#f-shell-width_mm', '16');
  await visit.check('cards of an earlier design are marked', () => document.querySelector('.results.outdated') && /earlier design or earlier targets/.test(document.querySelector('#search-status').textContent));
  await visit.click('.design button');
  await visit.addressHas('shell.width_mm=16');
  await visit.click('#undo');
  await visit.click('#undo');
  await visit.check('after undo they are not marked', () => !document.querySelector('.results.outdated'));
  await visit.settled();
}

export async function closingCardsKeepsAFit(visit, site, { table }) {
  await visit.open(`${site.address}${START}&targets.threshold_n=24`);
  await searched(visit);
  await visit.drop('plateaus.csv', table);
  await visit.click('#results-close');
  const verdict = await visit.page.waitForSelector('#verdict b', { timeout: SLOW_MS }).then(() => true, () => false);
  visit.findings.check('closing the cards does not end the fit of a table', verdict, await visit.text('#verdict'));
  await visit.settled();
}

export async function filesDuringASearch(visit, site) {
  await visit.open(`${site.address}${START}&targets.threshold_n=24`);
  await visit.click('#search');
  await visit.click('#download');
  await visit.check('files that wait for a search report it', () => /Waiting for the search for designs/.test(document.querySelector('#files-status').textContent));
  await visit.page.waitForSelector('#file-list li', { timeout: SLOW_MS });
  visit.findings.check('the report is removed when the files are listed', await visit.text('#files-status') === '', await visit.text('#files-status'));
  await visit.click('#files-close');
  await visit.settled();
}

export async function invalidText(visit, site) {
  await visit.open(site.address + START);
  const box = '#f-silicone-thickness_mm';
  const isValid = (selector) => document.querySelector(selector).value === '2' && !document.querySelector(selector).hasAttribute('aria-invalid');
  await visit.focus(box);
  await visit.page.keyboard.press('Home');
  for (let i = 0; i < 4; i += 1) await visit.page.keyboard.press('Delete');
  await visit.check('an empty input is reported', (selector) => document.querySelector(selector).getAttribute('aria-invalid') === 'true', box);
  await visit.focus('#explode');
  await visit.check('after blur it shows the value of the design', isValid, box);
  await visit.type('#f-segment-grooves', '17.5');
  await visit.focus('#explode');
  await visit.check('a fraction of a groove changes nothing', () => document.querySelector('#f-segment-grooves').value === '15' && !document.querySelector('#f-segment-grooves').hasAttribute('aria-invalid'));
  await visit.type('#f-segment-grooves', '7');
  await visit.check('too few grooves for the pins are refused', () => document.body.classList.contains('stale'));
  await visit.click('#mirror-pins');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.type('#f-segment-grooves', '15');
  await visit.settled();
  await visit.click('#add-friction');
  await visit.addressHas('targets.friction=');
  await visit.type('#target-frictions input', '-3');
  await visit.check('an invalid target is reported', () => /above 0/.test(document.querySelector('#targets-status').textContent));
  const target = await visit.page.evaluate(() => /targets\.friction=[\d.]+:([\d.]+)/.exec(decodeURIComponent(location.hash))[1]);
  await visit.focus('#explode');
  await visit.check('after blur the input shows the target', (value) => Number(document.querySelector('#target-frictions input').value) === Number(value) && document.querySelector('#targets-status').hidden, target);
  await visit.type('#target-threshold', '1e9');
  await visit.addressLacks('targets.threshold_n=1000000000');
  await visit.settled();
}

export async function comparisonOfARefusedDesign(visit, site) {
  await visit.open(site.address + START);
  await visit.type('#f-layout-pins', '5, 6, 7, 99');
  await visit.check('the design is refused', () => document.body.classList.contains('stale'));
  await visit.click('#keep-curve');
  await visit.check('the comparison is the curve that is shown', legendHas, '[4, 8, 12]');
  visit.findings.check('and not that of the refused design', !(await visit.text('#legend')).includes('99'));
}

export async function printerUnderTheDesign(visit, site, { facts }) {
  const printers = facts.templates.filter((t) => t.kind === 'printer' && t.values['print.bed_mm'] !== undefined);
  await visit.open(`${site.address}${START}&print.bed_mm=151`);
  const choose = async (name) => {
    await visit.page.$eval('#more', (menu) => { menu.open = true; });
    await (await visit.page.evaluateHandle((n) => [...document.querySelectorAll('#template-list button')].find((b) => b.querySelector('b')?.textContent === n), name)).click();
    await visit.settled();
  };
  await choose(printers[0].name);
  await visit.addressHas('print.bed_mm=151');
  await visit.check('a kept value is reported', () => /values are kept: .*side of the bed/.test(document.querySelector('#toast').textContent));
  const others = facts.templates.filter((t) => t.kind === 'printer');
  const [first, second] = others;
  await visit.open(site.address + START);
  await choose(first.name);
  await choose(second.name);
  const values = await visit.page.evaluate(() => decodeURIComponent(location.hash));
  const wanted = Object.entries(second.values).filter(([path]) => path in first.values).map(([path, value]) => `${path}=${value}`);
  visit.findings.check('one printer replaces another', wanted.every((pair) => values.includes(pair) || pair.includes('true') || pair.includes('false')) || wanted.length === 0, `${values} lacks one of ${wanted}`);
}

export async function undoUnderTheDialog(visit, site) {
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

export async function invalidModel(visit, site) {
  await visit.open(site.address + START);
  await visit.drop('model.toml', 'schema = "pinswitch.model/1"\nname = "x"\n');
  await visit.check('an invalid model is refused', () => /Cannot open model\.toml/.test(document.querySelector('#notice').textContent));
  await visit.addressLacks('model=');
  await visit.settled();
}

export async function nameOfAnOpenedFile(visit, site) {
  await visit.open(site.address + START);
  await visit.drop('My Part.toml', '[layout]\npins = [7]\n');
  await visit.addressHas('switch.name=My Part');
  await visit.check('the name of the file is the name of the design', () => document.querySelector('#name').textContent === 'My Part');
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

// A file that another program has changed is not overwritten without a question.
export async function fileChangedElsewhere(visit, site, { anotherView, facts }) {
  if (site.file) return;
  const view = await anotherView('meanwhile.toml', '[layout]\npins = [3, 8, 13]\n[silicone]\nthickness_mm = 3.0\n');
  const grooves = facts.fields.find((f) => f.path === 'segment.grooves').default;
  try {
    // An earlier address with another design.
    await visit.open(view.address + START);
    await visit.type('#f-silicone-hardness_shore_a', '40');
    await visit.settled();
    await visit.click('#save');
    await visit.check('saving asks first', () => /Not saved.*pins in/s.test(document.querySelector('#notice').textContent));
    const before = readFileSync(view.followed, 'utf8');
    visit.findings.check('the file is unchanged', before.includes('[3, 8, 13]') && before.includes('3.0'), before);
    await (await visit.page.evaluateHandle(() => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === 'Overwrite it'))).click();
    await visit.check('on request it is overwritten', () => /Saved to meanwhile\.toml/.test(document.querySelector('#toast').textContent));
    visit.findings.check('the file has the values of the page', readFileSync(view.followed, 'utf8').includes('[4, 8, 12]'));
    writeFileSync(view.followed, '[layout]\npins = [5, 9]\n');
    await visit.addressHas('layout.pins=5,9');
    await visit.settled();
    await visit.focus(`[data-groove="${grooves}"]`);
    await visit.page.keyboard.press('Space');
    await visit.settled();
    await visit.click('#save');
    await visit.check('a followed file is saved without a question', () => /Saved to meanwhile\.toml/.test(document.querySelector('#toast').textContent) && document.querySelector('#notice').hidden);
    visit.findings.check('with the added pin', readFileSync(view.followed, 'utf8').includes(`[5, 9, ${grooves}]`), readFileSync(view.followed, 'utf8'));
    await visit.page.reload();
    await visit.settled();
    visit.findings.check('after a reload the file is known', await visit.page.$eval('#notice', (e) => e.hidden));
    const address = await visit.page.evaluate(() => location.hash);
    await visit.page.goto('about:blank');
    writeFileSync(view.followed, '[layout]\npins = [6, 10]\n');
    await new Promise((done) => setTimeout(done, 1500));
    await visit.open(view.address + address);
    await visit.check('a difference between address and file is reported', () => /differs from meanwhile\.toml/.test(document.querySelector('#notice').textContent));
  } finally {
    await visit.page.goto('about:blank');
    await view.end();
  }
}
