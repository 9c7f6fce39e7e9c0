// What people do: swipe on a phone, type numbers their way, read messages, share, print.

import { Visit } from './driver.mjs';
import { START } from './design.mjs';

const SLOW_MS = 240_000;
const pause = (ms) => new Promise((done) => { setTimeout(done, ms); });
const hashOf = (visit) => visit.page.evaluate(() => decodeURIComponent(location.hash));

// A touch from a point, in steps; the last one is the end.
async function touch(visit, [x, y], [dx, dy], steps = 10) {
  const session = await visit.page.createCDPSession();
  const send = (type, points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  await send('touchStart', [{ x, y }]);
  for (let i = 1; i <= steps; i += 1) await send('touchMove', [{ x: x + (dx * i) / steps, y: y + (dy * i) / steps }]);
  await send('touchEnd', []);
  await session.detach();
  await pause(150);
}

// On a phone: a swipe scrolls and edits nothing, a drag edits, and what the design does stays in view.
export async function phone(_, site, { findings }) {
  const visit = await Visit.begin(_.browser, { width: 375, height: 740, findings, showsAll: false });
  await visit.open(site.address + START);
  await visit.click('#parameters');
  await visit.check('the sheet shows how to close it', () => document.querySelector('#sheet-close').getBoundingClientRect().top > 0 && document.querySelector('#sheet-close').checkVisibility());
  const sliders = await visit.page.$$('#fields .field:not([hidden]) input[type=range]');
  findings.check('the first screen has few parameters', sliders.length >= 5 && sliders.length <= 10, sliders.length);
  const before = await hashOf(visit);
  for (const slider of sliders.slice(0, 5)) {
    for (const share of [0.15, 0.5, 0.9]) {
      await slider.evaluate((e) => e.scrollIntoView({ block: 'center' }));
      const box = await slider.boundingBox();
      await touch(visit, [box.x + share * box.width, box.y + box.height / 2], [6, -120]);
    }
    await slider.evaluate((e) => e.scrollIntoView({ block: 'center' }));
    const box = await slider.boundingBox();
    await touch(visit, [box.x + 0.8 * box.width, box.y + box.height / 2], [0, 0], 1);
  }
  await pause(400);
  await visit.check('swipes and taps over sliders change nothing', (hash) => decodeURIComponent(location.hash) === hash, before);
  await sliders[1].evaluate((e) => e.scrollIntoView({ block: 'center' }));
  const box = await sliders[1].boundingBox();
  await touch(visit, [box.x + 0.4 * box.width, box.y + box.height / 2], [60, 2]);
  await visit.check('a drag along a slider changes it', (hash) => decodeURIComponent(location.hash) !== hash, before);
  await visit.check('the sheet still shows how to close it', () => { const r = document.querySelector('#sheet-close').getBoundingClientRect(); return document.elementFromPoint(r.x + r.width / 2, r.y + r.height / 2)?.id === 'sheet-close'; });
  await visit.check('what the design does is in view', () => document.querySelector('#strip').checkVisibility() && /switches at|does not switch/.test(document.querySelector('#strip').textContent));
  await visit.click('#sheet-close');
  await visit.check('the sheet closes', () => !document.body.classList.contains('sheet'));
  await visit.end();
}

// A thumb moves in an arc: what starts along a slider and then scrolls edits nothing.
export async function thumbs(_, site, { findings }) {
  if (_.browser.isFirefox) return;
  const visit = await Visit.begin(_.browser, { width: 375, height: 667, findings, showsAll: false });
  await visit.open(site.address + START);
  const free = () => ['download', 'share', 'undo', 'redo', 'more'].filter((id) => {
    const r = document.getElementById(id).getBoundingClientRect();
    return document.elementFromPoint(r.x + r.width / 2, r.y + r.height / 2)?.closest(`#${id}`) === null;
  });
  findings.check('nothing covers the header', (await visit.page.evaluate(free)).length === 0, await visit.page.evaluate(free));
  await visit.click('#parameters');
  const before = await hashOf(visit);
  const session = await visit.page.createCDPSession();
  const send = (type, points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  for (const slider of (await visit.page.$$('#fields .field:not([hidden]) input[type=range]')).slice(0, 5)) {
    await slider.evaluate((e) => e.scrollIntoView({ block: 'center' }));
    const { x, y, width, height } = await slider.boundingBox();
    const [left, top] = [x + 0.62 * width, y + height / 2];
    await send('touchStart', [{ x: left, y: top }]);
    for (const [dx, dy] of [[8, -2], [16, -6], [24, -14], [30, -26], [34, -36]]) await send('touchMove', [{ x: left + dx, y: top + dy }]);
    await send('touchEnd', []);
    await pause(200);
  }
  await pause(400);
  await visit.check('arcs over sliders change nothing', (hash) => decodeURIComponent(location.hash) === hash, before);
  await visit.click('#sheet-close');
  for (const mark of ['.grip.threshold', '.grip.diamond', '[data-groove="8"]']) {
    for (const path of [[[5, -1], [11, -3], [17, -6], [22, -14], [26, -30], [29, -60], [31, -100]], [[8, -2], [16, -6], [24, -14], [30, -26], [34, -36]]]) {
      if (mark === '[data-groove="8"]' && path.at(-1)[1] > -50) continue;
      await visit.page.$eval(mark, (e) => e.scrollIntoView({ block: 'center' }));
      const { x, y, width, height } = await (await visit.page.$(mark)).boundingBox();
      const [left, top] = [x + width / 2, y + height / 2];
      await send('touchStart', [{ x: left, y: top }]);
      for (const [dx, dy] of path) await send('touchMove', [{ x: left + dx, y: top + dy }]);
      await send('touchEnd', []);
      await pause(300);
      await visit.check(`an arc over ${mark} changes nothing`, (hash) => decodeURIComponent(location.hash) === hash, before);
    }
  }
  await visit.end();
}

// The first screen: one sentence, three steps, and a switch that moves.
export async function firstScreen(_, site, { findings }) {
  const visit = await Visit.begin(_.browser, { findings, showsAll: false });
  await visit.open(site.address);
  findings.check('one sentence says what it is', (await visit.text('.intro')).trim().split(/\.\s/).length === 1, await visit.text('.intro'));
  findings.check('three steps follow', await visit.page.$$eval('#steps button', (all) => all.map((e) => e.textContent).join('|')) === 'What should it do?|Does it do it?|Make it');
  const rope = () => visit.page.$eval('#pins .tendon', (e) => e.getAttribute('d'));
  await visit.slide('#load', 5);
  const light = await rope();
  await visit.slide('#load', 45);
  findings.check('the cross-section moves with the load', await rope() !== light);
  await visit.page.$$eval('#steps button', (all) => all[0].click());
  await visit.check('a step leads to its place', () => document.querySelector('#targets-title').getBoundingClientRect().top < innerHeight);
  if (!_.browser.isFirefox) {
    const moving = await Visit.begin(_.browser, { findings, showsAll: false });
    await moving.page.emulateMediaFeatures([{ name: 'prefers-reduced-motion', value: 'no-preference' }]);
    await moving.open(site.address);
    if (site.file) await moving.check('the switch moves on a first visit', () => document.querySelector('#play').getAttribute('aria-pressed') === 'true');
    await moving.page.keyboard.press('Shift');
    await moving.check('until a person does something', () => document.querySelector('#play').getAttribute('aria-pressed') === 'false');
    await moving.click('#play');
    const load = await moving.text('#load-value');
    await moving.check('and again on demand', (was) => document.querySelector('#load-value').textContent !== was, load);
    await moving.click('#play');
    await moving.end();
  }
  await visit.end();
}

// Fields without an effect on the design are not shown, unless they were changed.
export async function needlessFields(visit, site, { findings }) {
  await visit.open(`${site.address}#v=1&layout.substrate=abs&layout.pins=5,8,11`);
  const shown = (path) => visit.page.$eval(`#f-${path.replace('.', '-')}-field`, (e) => !e.hidden);
  findings.check('a rigid switch has no silicone', !await shown('silicone.thickness_mm'));
  findings.check('without a mount, the mount has no sizes', await shown('mount.kind') && !await shown('mount.flange_thickness_mm').catch(() => false));
  await visit.open(`${site.address}#v=1&layout.substrate=abs&layout.pins=5,8,11&silicone.thickness_mm=3`);
  findings.check('what was changed stays', await shown('silicone.thickness_mm'));
}

// A message is in front of everything, and its cross closes it.
export async function messages(visit, site) {
  for (const [width, height] of [[1440, 900], [820, 1100], [375, 740]]) {
    await visit.look(width, height, false);
    await visit.open(site.address + START);
    await visit.page.evaluate(() => scrollTo(0, document.body.scrollHeight));
    await visit.drop('x.toml', 'not = [toml');
    await visit.check(`a message is shown at ${width} px`, () => !document.querySelector('#notice').hidden);
    await visit.check(`its cross is not covered at ${width} px`, () => {
      const r = document.querySelector('#notice .tiny').getBoundingClientRect();
      return document.elementFromPoint(r.x + r.width / 2, r.y + r.height / 2)?.closest('#notice') !== null;
    });
    await visit.click('#notice .tiny');
    await visit.check(`it closes at ${width} px`, () => document.querySelector('#notice').hidden);
    await visit.page.evaluate(() => scrollTo(0, 0));
  }
}

// Numbers as people type them.
export async function numbers(visit, site, { findings }) {
  await visit.open(site.address + START);
  const input = '#f-silicone-thickness_mm';
  for (const [text, value] of [['2,5', 2.5], ['2*1.2', 2.4], ['0.1 in', 2.54], ['1/16 in', 1.5875], ['0.25 cm', 2.5], ['(1 + 2)/2 mm', 1.5], [' 2.25 ', 2.25]]) {
    await visit.type(input, text);
    await visit.page.keyboard.press('Tab');
    await visit.addressHas(`silicone.thickness_mm=${value}`);
    findings.check(`${text} is shown as a number`, await visit.page.$eval(input, (e) => e.value) === String(value), await visit.page.$eval(input, (e) => e.value));
  }
  for (const text of ['2,5,5', 'two', '2 N', '1,234', '0.05 + 0.05 in']) {
    const before = await hashOf(visit);
    await visit.type(input, text);
    await visit.check(`${text} is refused aloud`, () => document.querySelector('#f-silicone-thickness_mm-error').checkVisibility());
    await visit.page.keyboard.press('Tab');
    // The address is written a moment after the design: it may still have the number that the text began with.
    await pause(400);
    await visit.check(`${text} changes nothing`, (hash) => decodeURIComponent(location.hash) === hash, before);
  }
  await visit.type(input, '2');
  await visit.page.keyboard.press('ArrowUp');
  await visit.addressHas('silicone.thickness_mm=2.01');
  await visit.type('#target-threshold', '22,5');
  await visit.addressHas('targets.threshold_n=22.5');
  for (const [word, field] of [['cable', 'tendon-rope_diameter_mm'], ['mold', 'mould-kind'], ['rubber', 'silicone-hardness_shore_a'], ['screw', 'fasteners-kind']]) {
    await visit.type('#find', word);
    await visit.check(`${word} finds its field`, (id) => document.querySelector(`#f-${id}`).checkVisibility(), field);
  }
}

// Enter searches; the search varies what that of the command line varies, and explains what it misses.
export async function searchByEnter(visit, site, { findings }) {
  await visit.open(site.address + START);
  await visit.type('#target-threshold', '24');
  await visit.page.keyboard.press('Enter');
  await visit.page.waitForSelector('#designs .design', { timeout: SLOW_MS });
  const cards = await visit.text('#designs');
  findings.check('the designs say what is uncertain', /Sources of uncertainty: /.test(cards), cards);
  await visit.check('the result is in view', () => { const r = document.querySelector('#results').getBoundingClientRect(); return r.top < innerHeight && r.bottom > 0; });
  await visit.type('#target-threshold', '49');
  await visit.click('#add-friction');
  await visit.type('#target-frictions label:nth-child(2) input', '40');
  await visit.type('#target-frictions label:nth-child(1) input', '30');
  await visit.page.keyboard.press('Enter');
  await visit.page.waitForFunction(() => !document.querySelector('#blocked').hidden, { timeout: SLOW_MS });
  findings.check('what is missed is explained', /no design meets the request|no printable design/.test(await visit.text('#blocked')), await visit.text('#blocked'));
}

// A person's readings are on the curve, with residuals and sizes, also after a reload.
export async function bench(visit, site, { findings, table }) {
  await visit.open(`${site.address}#v=1&layout.pins=6,8,10&layout.substrate=abs`);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#fit:not([hidden])', { timeout: SLOW_MS });
  await visit.check('the readings are on the curve', () => /your readings \(\d+\)/.test(document.querySelector('#legend').textContent));
  const shown = () => document.querySelectorAll('.residuals .before').length > 10 && document.querySelectorAll('.bars li').length > 0 && /95 % interval/.test(document.querySelector('#fit').textContent);
  await visit.check('residuals, probabilities and sizes are shown', shown);
  await visit.page.reload();
  await visit.settled();
  await visit.check('they are shown after a reload', shown);
  findings.check('with the verdict', /plateaus\.csv: /.test(await visit.text('#verdict')));
  await visit.type('#f-layout-pins', '4, 8, 12');
  await visit.check('readings of another layout are not on the curve', () => !/your readings/.test(document.querySelector('#legend').textContent));
}

// An address of this computer is not shared: the design is, as text that the page opens again.
export async function sharing(visit, site, { findings }) {
  await visit.open(`${site.address}#v=1&layout.pins=4,8,12`);
  await visit.page.evaluate(() => { navigator.clipboard.writeText = async (text) => { window.copied = text; }; });
  await visit.click('#share');
  await visit.until(() => window.copied !== undefined);
  const copied = await visit.page.evaluate(() => window.copied);
  findings.check('the design is copied, not an address of this computer', /pins = \[4, 8, 12\]/.test(copied) && !/localhost|127\.0\.0\.1/.test(copied), copied);
  await visit.open(site.address + START);
  await visit.page.evaluate((text) => {
    const clipboardData = new DataTransfer();
    clipboardData.setData('text/plain', text);
    document.body.dispatchEvent(new ClipboardEvent('paste', { clipboardData, bubbles: true, cancelable: true }));
  }, copied);
  await visit.addressHas('layout.pins=4,8,12');
}

// No position of a slider is refused by a rule; a typed value beyond its reach is, with fixes that keep it.
export async function slidersWithinReach(visit, site) {
  await visit.open(site.address + START);
  // Those of the first screen; a unit test of the engine has all.
  await visit.page.$eval('#all-parameters', (box) => { if (box.checked) box.click(); });
  const ids = await visit.page.$$eval('#fields .field:not([hidden]) input[type=range]', (all) => all.map((slider) => slider.closest('.field').id));
  const refused = [];
  for (const id of ids) {
    for (const position of [0, 900, 1000]) {
      await visit.slide(`#${id} input[type=range]`, position);
      // The engine answers what the reach is before the value changes.
      await pause(150);
      await visit.settled();
      if (await visit.shown('#trouble')) refused.push(`${id} at ${position}: ${await visit.text('#trouble')}`);
      await visit.page.evaluate((start) => { location.hash = start; }, START);
      await visit.settled();
    }
  }
  visit.findings.check('the first screen has few sliders', ids.length > 5 && ids.length <= 10, ids.length);
  visit.findings.check('no position of a slider is refused', refused.length === 0, refused.join(' | '));
}
