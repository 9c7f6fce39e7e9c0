// Targets, the search for designs, and the cards of proposed designs.

import { START } from './design.mjs';

// A search takes seconds, and longer on a busy machine.
const SLOW_MS = 120_000;

export async function search(visit, site) {
  await visit.open(site.address + START);
  await visit.click('#search');
  await visit.check('a search without targets asks for them', () => /First enter/.test(document.querySelector('#targets-status').textContent));
  // The mark on the plot is moved with the pointer and by key.
  await visit.page.$eval('.grip.threshold', (e) => e.scrollIntoView({ block: 'center' }));
  const grip = await (await visit.page.$('.grip.threshold')).boundingBox();
  const { mouse } = visit.page;
  await mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
  await mouse.down();
  await mouse.move(grip.x + 40, grip.y + 8, { steps: 3 });
  await mouse.up();
  await visit.addressHas('targets.threshold_n=');
  await visit.type('#target-threshold', '24');
  await visit.addressHas('targets.threshold_n=24');
  const isInFront = () => getComputedStyle(document.querySelector('.threshold-line.current')).zIndex > 0 && getComputedStyle(document.querySelector('.threshold-line.current'), '::after').backgroundColor !== 'rgba(0, 0, 0, 0)';
  visit.findings.check('the line of the target does not cross the label of the present threshold', await visit.page.evaluate(isInFront));
  await visit.focus('.grip.diamond');
  await visit.page.keyboard.press('ArrowUp');
  await visit.addressHas('targets.friction=');
  await visit.click('#target-frictions .tiny');
  await visit.addressLacks('targets.friction');
  const top = () => visit.page.$eval('#search', (e) => e.getBoundingClientRect().top);
  const place = await top();
  await visit.click('#search');
  visit.findings.check('the button stays under the pointer', await top() === place, `${place} ${await top()}`);
  const reports = await visit.page.evaluate(async () => {
    const texts = new Set();
    for (let i = 0; i < 35 && !document.querySelector('#stop').hidden; i += 1) {
      texts.add(document.querySelector('#search-status').textContent);
      await new Promise((done) => { setTimeout(done, 100); });
    }
    return [...texts].filter((text) => /Searching/.test(text));
  });
  visit.findings.check('the time of a search is not reported each second', reports.length === 1, reports.join(' / '));
  await visit.page.waitForSelector('#designs .design', { timeout: SLOW_MS });
  const cards = await visit.page.$$eval('.design', (all) => all.map((c) => [c.querySelector('.error') ? 1 : 0, Number(/(\d+) % probable/.exec(c.textContent)?.[1])]));
  visit.findings.check('the designs are cards, printable ones first, the most probable first', cards.length > 1 && cards.every(([review, p], i) => p >= 0 && p <= 100 && (i === 0 || review > cards[i - 1][0] || (review === cards[i - 1][0] && p <= cards[i - 1][1]))), cards);
  visit.findings.check('all designs are on the chart', /proposed designs \(\d\)/.test(await visit.text('#legend')), await visit.text('#legend'));
  await visit.page.$eval('.design details', (e) => { e.open = true; });
  visit.findings.check('a card says what a change buys', /thickness \+0\.1 mm[+-][\d.]+ N/.test(await visit.text('.design details')), await visit.text('.design details'));
  await visit.page.$eval('.design details', (e) => { e.open = false; });
  await visit.page.hover('.design:nth-child(2)');
  await visit.check('a card shows its curve', () => /design 2/.test(document.querySelector('#legend').textContent));
  const pins = await visit.page.$eval('.design:nth-child(2)', (card) => /pins \[([\d, ]+)\]/.exec(card.textContent)[1].replaceAll(' ', ''));
  await visit.click('.design:nth-child(2) button');
  await visit.settled();
  await visit.check('one click applies a design', (applied) => document.querySelector('#pins-title').textContent.replaceAll(' ', '') === `Pinsin${applied}`, pins);
  await visit.type('#target-threshold', '24');
  await visit.click('#add-friction');
  await visit.type('#target-frictions label:nth-child(2) input', '40');
  await visit.type('#target-frictions label:nth-child(1) input', '8.5');
  await visit.addressHas('targets.friction=40:8.5');
  await visit.click('#search');
  await visit.page.waitForFunction(() => /target: 8\.5 N/.test(document.querySelector('#designs').textContent), { timeout: SLOW_MS });
  const card = await visit.page.$eval('.design', (e) => [...e.children].filter((part) => part.tagName !== 'DETAILS').map((part) => part.textContent).join(' '));
  visit.findings.check('a card has each target, and the other properties once', /switches at [\d.]+ N; target: 24 N/.test(card) && /[\d.]+ N at 40 N of load; target: 8\.5 N/.test(card) && card.split('heaviest').length === 2, card);
  // What the search may change is chosen.
  await visit.page.$eval('#vary', (e) => { e.closest('details').open = true; });
  await visit.page.$$eval('#vary input', (all) => all.forEach((box) => { if (box.checked !== (box.value === 'hardness_shore_a')) box.click(); }));
  await visit.click('#search');
  await visit.page.waitForFunction(() => document.querySelector('#stop').hidden && /hardness/.test(document.querySelector('.design').textContent), { timeout: SLOW_MS });
  visit.findings.check('only the chosen parameter changes', await visit.page.$$eval('.design', (all) => all.every((card) => /pins \[/.test(card.textContent) && !/span [\d.]+ °/.test(card.querySelector('details').previousSibling.textContent))));
  // A refused text leaves the target before.
  await visit.type('#target-threshold', '1.234,5');
  await visit.page.keyboard.press('Tab');
  await visit.check('a refused target leaves the one before', () => document.querySelector('#target-threshold').value === '24' && /still 24 N/.test(document.querySelector('#toast').textContent));
  visit.findings.check('the probability is explained', await visit.shown('#probability-note') && /within 10 %/.test(await visit.text('#probability-note')), await visit.text('#probability-note'));
  await visit.click('#results-close');
  await visit.check('the cards are closed', () => document.querySelector('#results').hidden);
}
