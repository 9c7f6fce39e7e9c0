// The keyboard's place: when what has the focus goes, a sensible neighbour takes it, never the page's beginning.

import { START } from './design.mjs';

const SLOW_MS = 120_000;

// Presses what has this selector, waits until the focus is elsewhere, and tells where.
async function press(visit, selector) {
  const element = await visit.page.waitForSelector(selector, { visible: true });
  await element.focus();
  await visit.page.keyboard.press('Enter');
  await visit.page.waitForFunction((e) => document.activeElement !== e, {}, element).catch(() => {});
  return visit.page.evaluate(() => {
    const at = document.activeElement;
    return at === document.body ? 'body' : at.id || at.getAttribute('aria-label') || at.dataset.groove || at.textContent;
  });
}

async function goes(visit, what, selector, to) {
  const at = await press(visit, selector);
  visit.findings.check(`after ${what} the focus is at ${to.source}`, to.test(at), at);
}

async function refused(visit) {
  await visit.type('#f-segment-grooves', '40');
  await visit.page.waitForSelector('#trouble .mend', { visible: true });
  await visit.settled();
}

export async function focusAfterMending(visit, site) {
  await visit.open(site.address + START);
  await refused(visit);
  await goes(visit, 'mending at the control', '#f-segment-grooves-error .mend', /^f-segment-grooves$/);
  await visit.settled();
  await refused(visit);
  await goes(visit, 'mending above the view', '#trouble .mend', /^f-segment-grooves$/);
  await visit.settled();
  await refused(visit);
  await goes(visit, 'undoing above the view', '#trouble .btn:last-child', /^undo$/);
  await visit.settled();
  while (await visit.page.$eval('#undo', (e) => !e.disabled)) {
    await visit.focus('#undo');
    await visit.page.keyboard.press('Enter');
  }
  await visit.check('undone to the end, the focus is at Redo', () => document.activeElement.id === 'redo');
  await visit.settled();
  await visit.drop('a.png', 'PNG');
  await visit.page.waitForSelector('#notice .tiny', { visible: true });
  await goes(visit, 'closing a notice', '#notice .tiny', /^apart$/);
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.click('#only-changed');
  await goes(visit, 'resetting what is then hidden', '#f-silicone-thickness_mm-field [aria-label^="Reset"]', /^(f-layout-pins|Reset pins in)$/);
  await goes(visit, 'resetting the last', '#f-layout-pins-field [aria-label^="Reset"]', /^(find|only-changed)$/);
  await visit.click('#only-changed');
  await visit.settled();
  await visit.open(site.address + START);
  await goes(visit, 'lifting all pins', '#clear-pins', /^Groove \d+, empty$/);
  await visit.click('#more > summary');
  await goes(visit, 'closing a menu', '#template-list button:not(.narrow)', /^More$/);
  await visit.settled();
}

export async function focusAfterAsking(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.click('#add-friction');
  await goes(visit, 'removing the last friction', '#ask-frictions .tiny', /^add-friction$/);
  await visit.type('#ask-threshold', '24');
  await visit.addressHas('ask.threshold_n=24');
  await goes(visit, 'beginning a search', '#search', /^stop$/);
  await visit.page.waitForFunction(() => document.querySelector('#stop').hidden, { timeout: SLOW_MS });
  visit.findings.check('after a search the focus is at its cards', await visit.page.evaluate(() => document.activeElement.id === 'designs'));
  await visit.click('#found-close');
  await visit.focus('#search-here');
  await visit.page.keyboard.press('Enter');
  await goes(visit, 'stopping a search', '#stop', /^(designs|search)$/);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#take-model:not([hidden])', { timeout: SLOW_MS });
  await goes(visit, 'taking a model', '#take-model', /^drop-model$/);
  await visit.settled();
  await goes(visit, 'going back to the published constants', '#drop-model', /^take-model$/);
  await visit.settled();
}
