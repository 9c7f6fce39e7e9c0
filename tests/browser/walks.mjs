// Five walks on the published page, each at three widths: what a person does who came for one thing. A picture of the end of each is
// kept.

import { mkdtempSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { Visit } from './driver.mjs';

const WIDTHS = [[375, 740], [820, 1100], [1440, 900]];
const SLOW_MS = 240_000;

// Walks at each width in a page of its own, as someone who never was there.
async function atEachWidth(name, { browser }, site, { findings, pictures, scratch }, walk) {
  if (site.name !== 'module') return;
  for (const [width, height] of WIDTHS) {
    const saves = mkdtempSync(join(scratch, 'walk-'));
    const visit = await Visit.begin(browser, { width, height, findings, saves, showsAll: false });
    visit.saves = saves;
    await walk(visit, width);
    const wide = await visit.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    findings.check(`${name}: nothing is wider than ${width} px`, wide <= 0, wide);
    await visit.page.screenshot({ path: join(pictures, `${site.name}-${browser.isFirefox ? 'firefox' : 'chromium'}-${name}-${width}.png`) });
    await visit.end();
  }
}

// The parameters are beside the design, or in a sheet over it.
const withParameters = async (visit, act) => {
  const isSheet = await visit.shown('#parameters');
  if (isSheet) await visit.click('#parameters');
  await act();
  if (isSheet) await visit.click('#sheet-close');
};

// Clicks, and returns the file that is then saved.
async function saved(visit, click) {
  await click();
  for (const until = Date.now() + 60_000; Date.now() < until;) {
    const [file] = readdirSync(visit.saves).filter((name) => !/part$|crdownload$/.test(name));
    const bytes = file && readFileSync(join(visit.saves, file));
    if (bytes?.length) return { file, bytes };
    await new Promise((done) => { setTimeout(done, 50); });
  }
  return { file: 'nothing', bytes: Buffer.alloc(0) };
}

export async function walkToAFirstSwitch(visit, site, shared) {
  await atEachWidth('first-switch', visit, site, shared, async (own) => {
    await own.open(site.address);
    await own.check('the page says what a switch is', () => /friction switch is a pulley/.test(document.querySelector('.intro').textContent));
    const before = await own.text('#friction-text');
    await withParameters(own, async () => {
      await own.type('#f-silicone-hardness_shore_a', '40');
      await own.page.keyboard.press('Tab');
      await own.addressHas('silicone.hardness_shore_a=40');
    });
    await own.settled();
    await own.check('the curve follows', (was) => document.querySelector('#friction-text').textContent !== was, before);
    await own.click('#download');
    await own.page.waitForSelector('#file-list button', { timeout: 60_000 });
    const { file, bytes } = await saved(own, () => own.click('#zip'));
    shared.findings.check('all files are saved', file.endsWith('.zip') && bytes.length > 1e5 && bytes.subarray(0, 2).toString() === 'PK', `${file} ${bytes.length}`);
  });
}

export async function walkToATarget(visit, site, shared) {
  await atEachWidth('target', visit, site, shared, async (own) => {
    await own.open(site.address);
    await own.type('#target-threshold', '24');
    await own.page.keyboard.press('Enter');
    await own.page.waitForSelector('#designs .design', { timeout: SLOW_MS });
    await own.check('the designs are in view', () => { const r = document.querySelector('#results').getBoundingClientRect(); return r.top < innerHeight && r.bottom > 0; });
    await own.click('.design button');
    await own.settled();
    const switches = Number(/switches at ([\d.]+) N/.exec(await own.page.evaluate(() => document.body.innerText))?.[1]);
    shared.findings.check('the applied design switches at the target', Math.abs(switches - 24) < 2.4, switches);
  });
}

export async function walkToTheDrawing(visit, site, shared) {
  await atEachWidth('drawing', visit, site, shared, async (own) => {
    await own.open(site.address);
    await own.click('#download');
    await own.page.waitForSelector('#file-list button', { timeout: 60_000 });
    const { file, bytes } = await saved(own, () => own.page.$$eval('#file-list button', (all) => all.find((b) => /drawing\.pdf/.test(b.closest('li, tr, div').textContent))?.click()));
    shared.findings.check('the drawing is saved', /drawing.*\.pdf$/.test(file) && bytes.subarray(0, 5).toString() === '%PDF-', `${file} ${bytes.length}`);
  });
}

export async function walkWithATable(visit, site, shared) {
  await atEachWidth('table', visit, site, shared, async (own) => {
    await own.open(`${site.address}#v=1&layout.pins=5,8,11`);
    await own.drop('plateaus.csv', shared.table);
    await own.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
    await own.check('the effect is named', () => /pins plough the coating/.test(document.querySelector('#verdict').textContent));
    await own.click('#use-model');
    await own.check('the curve is that of the rig', () => /your model/.test(document.querySelector('#trust').textContent));
    await own.settled();
  });
}

export async function walkThroughThePaper(visit, site, shared) {
  await atEachWidth('paper', visit, site, shared, async (own) => {
    await own.open(site.address);
    const curves = [];
    for (const name of ['three-single', 'six-single', 'three-double']) {
      await own.page.$$eval('#chips button', (all, wanted) => all.find((chip) => chip.textContent.includes(wanted)).click(), name);
      await own.settled();
      await own.slide('#load', 40);
      await own.check('the load is shown', () => /^40/.test(document.querySelector('#load-value').textContent));
      curves.push(await own.text('#friction-now'));
      if (name === 'three-single') await own.click('#keep-curve');
    }
    shared.findings.check('each layout of the paper has its friction', new Set(curves).size === 3, curves.join(' '));
    await own.check('two of their curves are side by side', () => /comparison: /.test(document.querySelector('#legend').textContent));
    await own.check('what the paper measured is on the chart', () => /measured in the paper/.test(document.querySelector('#legend').textContent));
    await own.page.evaluate(() => document.querySelector('#chart').scrollIntoView({ block: 'center' }));
  });
}
