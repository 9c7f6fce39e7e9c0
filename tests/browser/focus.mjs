// When the focused element disappears, a neighbour gets the focus, not the start of the page.

import { START } from './design.mjs';

const SLOW_MS = 120_000;

// Presses an element by key, waits until the focus is elsewhere, and returns where.
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

async function focusMoves(visit, what, selector, to) {
  const at = await press(visit, selector);
  visit.findings.check(`after ${what} the focus is at ${to.source}`, to.test(at), at);
}

async function refused(visit) {
  await visit.type('#f-segment-grooves', '40');
  await visit.page.waitForSelector('#trouble .fix', { visible: true });
  await visit.settled();
}

export async function focusAfterFixes(visit, site) {
  await visit.open(site.address + START);
  await refused(visit);
  await focusMoves(visit, 'a fix at the control', '#f-segment-grooves-error .fix:last-of-type', /^f-segment-grooves$/);
  await visit.settled();
  await refused(visit);
  await focusMoves(visit, 'a fix above the view', '#trouble .fix:nth-last-child(2)', /^f-segment-grooves$/);
  await visit.settled();
  await refused(visit);
  await focusMoves(visit, 'undo above the view', '#trouble .btn:last-child', /^undo$/);
  await visit.settled();
  while (await visit.page.$eval('#undo', (e) => !e.disabled)) {
    await visit.focus('#undo');
    await visit.page.keyboard.press('Enter');
  }
  await visit.check('after the last undo the focus is at Redo', () => document.activeElement.id === 'redo');
  await visit.settled();
  await visit.drop('a.png', 'PNG');
  await visit.page.waitForSelector('#notice .tiny', { visible: true });
  await focusMoves(visit, 'closing a notice', '#notice .tiny', /^explode$/);
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.click('#only-changed');
  await focusMoves(visit, 'resetting a field that is then hidden', '#f-silicone-thickness_mm-field [aria-label^="Reset"]', /^(f-layout-pins|Reset pins in)$/);
  await focusMoves(visit, 'resetting the last field', '#f-layout-pins-field [aria-label^="Reset"]', /^(find|only-changed)$/);
  await visit.click('#only-changed');
  await visit.settled();
  await visit.open(site.address + START);
  await focusMoves(visit, 'removing all pins', '#clear-pins', /^Groove \d+, empty$/);
  await visit.click('#more > summary');
  await focusMoves(visit, 'closing a menu', '#template-list button:not(.narrow)', /^Templates$/);
  await visit.settled();
}

export async function focusAfterSearch(visit, site, { table }) {
  await visit.open(site.address + START);
  await visit.click('#add-friction');
  await focusMoves(visit, 'removing the last friction', '#target-frictions .tiny', /^add-friction$/);
  await visit.type('#target-threshold', '24');
  await visit.addressHas('targets.threshold_n=24');
  await focusMoves(visit, 'starting a search', '#search', /^stop$/);
  await visit.page.waitForFunction(() => document.querySelector('#stop').hidden, { timeout: SLOW_MS });
  visit.findings.check('after a search the focus is at its cards', await visit.page.evaluate(() => document.activeElement.id === 'designs'));
  await visit.click('#results-close');
  await visit.focus('#search-here');
  await visit.page.keyboard.press('Enter');
  await focusMoves(visit, 'stopping a search', '#stop', /^(designs|search)$/);
  await visit.drop('plateaus.csv', table);
  await visit.page.waitForSelector('#use-model:not([hidden])', { timeout: SLOW_MS });
  await focusMoves(visit, 'using a model', '#use-model', /^remove-model$/);
  await visit.settled();
  await focusMoves(visit, 'going back to the published constants', '#remove-model', /^use-model$/);
  await visit.settled();
}
