// The 3D view and its sliders, three widths, two colour schemes, focus and accessibility.

import { START } from './design.mjs';

export async function assembly(visit, site) {
  await visit.open(site.address + START);
  let last = await visit.picture('#view');
  const changesPicture = async (what, act) => {
    await act();
    const now = await visit.picture('#view');
    visit.findings.check(what, now !== last);
    last = now;
  };
  const reading = await visit.text('#friction-text');
  await changesPicture('the load slider moves the pins', () => visit.slide('#load', 0));
  visit.findings.check('the load slider shows the friction', await visit.text('#friction-text') !== reading);
  await changesPicture('the view explodes', () => visit.slide('#explode', 1));
  await visit.slide('#explode', 0);
  last = await visit.picture('#view');
  await changesPicture('the section is shown', () => visit.click('#section'));
  await visit.click('#view-menu > summary');
  await changesPicture('the section moves', () => visit.slide('#section-position', 0.3));
  await changesPicture('the view rotates', () => visit.slide('#turn', 120));
  await changesPicture('the view tilts', () => visit.slide('#tilt', -20));
  await changesPicture('a body can be hidden', () => visit.page.$eval('#bodies input', (e) => e.click()));
  await visit.page.keyboard.press('Escape');
  const box = await (await visit.page.$('#view canvas')).boundingBox();
  const { mouse } = visit.page;
  await changesPicture('a drag rotates the view', async () => {
    await mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await mouse.down();
    await mouse.move(box.x + box.width / 2 + 90, box.y + box.height / 2 + 30, { steps: 4 });
    await mouse.up();
  });
  const facts = await visit.page.evaluate(() => ['#checks li', '#materials dt', '#parts tbody tr', '#bed svg .outline'].map((s) => document.querySelectorAll(s).length));
  visit.findings.check('checks, materials, parts and print bed are filled', facts.every((n) => n > 2), facts);
}

const WIDTHS = { phone: [375, 812], tablet: [820, 1180], desk: [1440, 900] };

// A joint turns between its stops with its slider and, unless motion is reduced, by itself.
export async function jointTurns(visit, site, { pictures }) {
  await visit.open(site.address + '#v=1&layout.pins=5,8,11&mount.kind=joint');
  const range = await visit.page.$eval('#flexion', (e) => [e.min, e.max, e.value].map(Number));
  visit.findings.check('the slider goes from stop to stop, from the wrap of the layout', range.join() === '0,75,64', range);
  const seen = new Set([await visit.picture('#view')]);
  for (const flexion of [0, 40, 75]) {
    await visit.slide('#flexion', flexion);
    seen.add(await visit.picture('#view'));
    await visit.page.screenshot({ path: `${pictures}/${site.name}-flexion-${flexion}.png` });
    const text = await visit.text('#flexion-value');
    visit.findings.check('the flexion and its wrap are shown', text.startsWith(`${flexion}°, wrap `), text);
  }
  visit.findings.check('each flexion has its picture', seen.size === 4, seen.size);
  for (const [width, height] of Object.values(WIDTHS)) {
    await visit.look(width, height, false);
    const wide = await visit.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    visit.findings.check(`controls and bill of a joint fit a width of ${width}`, wide <= 0, wide);
  }
  await visit.page.emulateMediaFeatures([{ name: 'prefers-reduced-motion', value: 'no-preference' }]);
  await visit.click('#flex');
  await visit.check('the link turns by itself', (was) => Number(document.getElementById('flexion').value) < was, 74);
  await visit.click('#flex');
  const stopped = await visit.page.$eval('#flexion', (e) => e.value);
  await new Promise((resolve) => setTimeout(resolve, 200));
  visit.findings.check('it stops', await visit.page.$eval('#flexion', (e) => e.value) === stopped);
  await visit.page.emulateMediaFeatures([{ name: 'prefers-reduced-motion', value: 'reduce' }]);
  // A browser tells the page of a changed preference with its next frame.
  await visit.check('with reduced motion only the slider is offered', () => document.querySelector('#flexion').checkVisibility() && !document.querySelector('#flex').checkVisibility());
  await visit.open(site.address + START);
  visit.findings.check('a switch without a joint has no slider', !await visit.shown('#flexion'));
}

export async function widths(visit, site, { pictures }) {
  await visit.open(site.address + START);
  const invalid = await visit.page.$$eval('[data-text], [data-name]', (all) => all.map((e) => `${e.textContent} ${e.getAttribute('aria-label')}`).filter((text) => /=>|undefined/.test(text)));
  visit.findings.check('every element has its text', invalid.length === 0, invalid.join('; '));
  for (const [name, [width, height]] of Object.entries(WIDTHS)) {
    for (const dark of [false, true]) {
      await visit.look(width, height, dark);
      const scheme = dark ? 'dark' : 'light';
      const wide = await visit.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      visit.findings.check(`nothing is wider than a ${name}`, wide <= 0, wide);
      const hero = await visit.page.evaluate(() => ['#view canvas', '#chart canvas', '#pins svg'].every((s) => document.querySelector(s).getBoundingClientRect().width > 200));
      visit.findings.check(`assembly, curve and pins have room on a ${name}`, hero);
      await visit.picture('body');
      await visit.page.screenshot({ path: `${pictures}/${site.name}-${name}-${scheme}.png` });
    }
  }
}

// On a phone, the floating button does not cover the focused element.
export async function focusOnAPhone(visit, site) {
  await visit.look(375, 812, false);
  await visit.open(site.address + START);
  const covered = new Set();
  const backwardSteps = [];
  let steps = 0, before;
  for (; steps < 120; steps += 1) {
    await visit.page.keyboard.press('Tab');
    const what = await visit.page.evaluate(async () => {
      await new Promise((done) => { requestAnimationFrame(done); });
      const [e, bar] = [document.activeElement, document.querySelector('.floating')];
      if (!e || e === document.body) return null;
      if (e === bar || e.matches('.group *, aside *')) return {};
      const [a, b] = [e.getBoundingClientRect(), bar.getBoundingClientRect()];
      const isCovered = a.right > b.left && a.left < b.right && a.bottom > b.top + 1 && a.top < b.bottom;
      return { name: e.id || e.outerHTML.slice(0, 80), isCovered, place: { top: a.top + scrollY, bottom: a.bottom + scrollY, left: a.left, scrolls: Boolean(e.closest('#chips')) } };
    });
    if (what === null) break;
    if (what.isCovered) covered.add(what.name);
    const { place } = what;
    // Elements in a horizontal scroller move with each step.
    if (place && before && !(place.scrolls && before.scrolls) && (place.bottom <= before.top || (place.left < before.left && place.top < before.bottom - 1 && place.bottom > before.top + 1))) backwardSteps.push(what.name);
    before = place ?? before;
  }
  visit.findings.check('the focus moves down the page, and to the right in a row', backwardSteps.length === 0, backwardSteps.join(' '));
  visit.findings.check('the focused element is never covered', steps > 20 && covered.size === 0, [...covered].join(' '));
}

// The search bar does not cover a focused parameter.
export async function focusAmongParameters(visit, site) {
  for (const [width, height] of [[1440, 900], [375, 812]]) {
    await visit.look(width, height, false);
    await visit.open(site.address + START);
    if (width < 1000) await visit.click('#parameters');
    await visit.page.evaluate(() => { document.querySelectorAll('.group').forEach((group) => { group.open = true; }); [...document.querySelectorAll('.group input:not([type=range])')].at(-1).focus(); });
    const covered = new Set();
    let steps = 0;
    for (; steps < 90; steps += 1) {
      await visit.page.keyboard.down('Shift');
      await visit.page.keyboard.press('Tab');
      await visit.page.keyboard.up('Shift');
      const what = await visit.page.evaluate(async () => {
        await new Promise((done) => { requestAnimationFrame(done); });
        const [e, bar] = [document.activeElement, document.querySelector('.finder')];
        if (!e.closest('.group')) return null;
        return e.getBoundingClientRect().top < bar.getBoundingClientRect().bottom - 1 ? e.id || e.outerHTML.slice(0, 80) : '';
      });
      if (what === null) break;
      if (what) covered.add(what);
    }
    visit.findings.check(`${width}: the focused parameter is never covered`, steps > 60 && covered.size === 0, `${steps} ${[...covered].join(' ')}`);
  }
}

// The reasons open and close with the pointer, by key, and by a click elsewhere, at each width.
export async function reasonsClose(visit, site) {
  await visit.open(site.address + START);
  const isOpen = () => visit.shown('#reasons');
  for (const width of [320, 375, 820, 1440]) {
    await visit.look(width, 812, false);
    const centre = async () => {
      await visit.page.$eval('#trust', (e) => e.scrollIntoView({ block: 'center' }));
      const { x, y, width: wide, height } = await (await visit.page.$('#trust')).boundingBox();
      return [x + wide / 2, y + height / 2];
    };
    const press = async () => visit.page.mouse.click(...await centre());
    await press();
    visit.findings.check(`the badge opens the reasons at ${width} px`, await isOpen());
    await press();
    visit.findings.check(`it closes them at ${width} px`, !await isOpen());
    await press();
    await visit.focus('#reasons');
    await visit.page.keyboard.press('Escape');
    visit.findings.check(`Escape closes them at ${width} px`, !await isOpen() && await visit.page.evaluate(() => document.activeElement.id === 'trust'));
    await press();
    await visit.click('#pins-title');
    visit.findings.check(`a click elsewhere closes them at ${width} px`, !await isOpen());
  }
}

// States of the page, each with functions that enter and leave it.
const MANY_REASONS = 'layout.pins=1,2,3,4,5,6,7,8,9,10,11,12,13,14,15&silicone.thickness_mm=6&silicone.hardness_shore_a=20';
async function goTo(visit, hash) {
  await visit.page.evaluate((to) => { document.body.dataset.pending = 'true'; location.hash = to; }, hash);
  await visit.settled();
}
const STATES = {
  'at rest': [async () => {}, async () => {}],
  'with reasons': [(v) => v.click('#trust'), (v) => v.click('#trust')],
  'with many reasons': [async (v) => { await goTo(v, `#v=1&${MANY_REASONS}`); await v.click('#trust'); }, async (v) => { await v.page.keyboard.press('Escape'); await goTo(v, START); }],
  'with templates': [(v) => v.click('#more > summary'), (v) => v.page.keyboard.press('Escape')],
  'with the view menu': [(v) => v.click('#view-menu > summary'), (v) => v.page.keyboard.press('Escape')],
  'with files': [async (v) => { await v.click('#download'); await v.page.waitForSelector('#file-list button'); }, (v) => v.click('#files-close')],
  'with a refusal': [async (v) => { await v.page.evaluate(() => { location.hash = '#v=1&segment.grooves=40'; }); await v.page.waitForSelector('#trouble:not([hidden])'); },
    async (v) => { await v.click('#trouble .fix'); await v.page.waitForSelector('#trouble[hidden]'); }],
};

async function violations(visit) {
  await visit.page.evaluate(() => new Promise((done) => setTimeout(done, 50)));
  return visit.page.evaluate(async () => (await axe.run(document, { resultTypes: ['violations'] })).violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(' ')).slice(0, 3).join(', ')}`));
}

// Embedded, without a header.
export async function accessibleEmbedded(visit, site) {
  await visit.open(`${site.address}?embed${START}`);
  await visit.page.evaluate(visit.browser.axeText);
  for (const name of ['desk', 'phone']) {
    await visit.look(...WIDTHS[name], false);
    const all = await violations(visit);
    visit.findings.check(`axe-core reports nothing on an embedded ${name}`, all.length === 0, all.join('; '));
  }
}

export async function accessible(visit, site) {
  await visit.open(site.address + START);
  // Through the debugger, since the policy of the page allows no other script.
  await visit.page.evaluate(visit.browser.axeText);
  for (const [name, dark] of [['desk', false], ['desk', true], ['phone', false], ['phone', true]]) {
    await visit.look(...WIDTHS[name], dark);
    const check = async (state) => {
      const all = await violations(visit);
      visit.findings.check(`axe-core reports nothing on a ${dark ? 'dark' : 'light'} ${name} ${state}`, all.length === 0, all.join('; '));
    };
    for (const [state, [enter, leave]] of Object.entries(STATES)) {
      await enter(visit);
      await check(state);
      await leave(visit);
    }
    if (name !== 'phone') continue;
    await visit.click('#parameters');
    await visit.page.waitForSelector('#find', { visible: true });
    await check('with parameters');
    await visit.click('#sheet-close');
  }
}
