// What is around the page: another page that embeds it, or the file that `pinswitch view` follows.

import { readFileSync, writeFileSync } from 'node:fs';
import { START } from './design.mjs';

// The server forbids to be framed, since its page can write a file; a site may be.
export async function embedded(visit, site) {
  if (!site.file) {
    await visit.open(`${site.address}?embed${START}`);
    visit.findings.check('?embed leaves the header out', !(await visit.shown('header')));
    return;
  }
  await visit.open(`${site.origin}/around.html`, { settles: false });
  const hears = (what, test, ...given) => visit.check(what, test, ...given);
  await hears('a page around hears of the first design', () => heard.some((m) => m.type === 'pinswitch-state' && m.version === 1 && m.friction_n > 0));
  await hears('a message at the frame\'s load is taken', () => heard.some((m) => String(m.values?.['layout.pins']) === '2,8,14'));
  const say = (message) => visit.page.evaluate((m) => { heard.length = 0; frames[0].postMessage(m, '*'); }, message);
  await say({ type: 'pinswitch-set', values: { 'layout.pins': [3, 8, 13] } });
  await hears('values go in, and the state comes out', () => heard.some((m) => String(m.values?.['layout.pins']) === '3,8,13' && m.hash.includes('layout.pins=3,8,13')));
  await say({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9' });
  await hears('an address goes in', () => heard.some((m) => String(m.values?.['layout.pins']) === '7,9' && m.trust));
  await say({ type: 'pinswitch-set', values: { 'segment.grooves': 40 } });
  await hears('trouble comes out in words', () => heard.some((m) => /segment\.grooves/.test(m.trouble)));
  await say({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9' });
  await hears('the design is shown again', () => heard.some((m) => m.hash === '#v=1&layout.pins=7,9' && m.trust && !m.trouble));
  await say({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9&ask.threshold_n=25&nonsense=1' });
  await hears('what is asked for is told, with what could not be taken', () => heard.some((m) => m.hash.includes('ask.threshold_n=25') && /nonsense/.test(m.said) && m.trust));
  await say({ type: 'pinswitch-set', hash: '#' });
  await hears('an empty address is told', () => heard.some((m) => /neither an address/.test(m.said)));
  await say({ type: 'pinswitch-set', hash: '#cut' });
  await hears('what is no design is told', () => heard.some((m) => /holds no design/.test(m.said)));
  await say({ type: 'pinswitch-set', values: { 'layout.pins': [4, 11] } });
  await hears('each state comes with its own answer', () => heard.some((m) => m.hash.includes('layout.pins=4,11') && m.said === null));
  // A model takes time to be read; what was said after it counts all the same.
  const long = await visit.page.frames()[1].evaluate(async () => (await packModel('slow', Array.from({ length: 4000 }, (_, i) => `# ${Math.sin(i)}`).join('\n'))).packed);
  await visit.page.evaluate((hash) => {
    heard.length = 0;
    frames[0].postMessage({ type: 'pinswitch-set', hash }, '*');
    frames[0].postMessage({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7' }, '*');
  }, `#v=1&layout.pins=2,3&model=${long}`);
  await hears('the later of two messages counts', () => heard.at(-1)?.hash === '#v=1&layout.pins=7');
  for (const [what, message] of [['neither', {}], ['a number for an address', { hash: 5 }], ['a list for values', { values: [] }], ['half a character', { values: { 'label.text': '\ud800' } }]]) {
    await say({ type: 'pinswitch-set', ...message });
    await hears(`${what} is told`, () => heard.some((m) => /neither an address nor values/.test(m.said)));
  }
  await say({ type: 'pinswitch-set', values: { 'layout.pins=3&x': 1 } });
  await hears('a name is no part of an address', () => heard.some((m) => /names layout/.test(m.said) && !/pins=3&/.test(m.hash)));
  // Many changes in a row: the friction of a layout is always that layout's.
  const pairs = await visit.page.evaluate(async () => {
    heard.length = 0;
    for (let i = 0; i < 24; i += 1) {
      frames[0].postMessage({ type: 'pinswitch-set', values: { 'layout.pins': i % 2 ? [5, 8, 11] : [2, 3, 4, 9, 13, 14] } }, '*');
      await new Promise((done) => { setTimeout(done, 7 * (i % 5)); });
    }
    await new Promise((done) => { setTimeout(done, 1500); });
    return heard.map((m) => [m.hash, m.friction_n]);
  });
  const frictions = (hash) => new Set(pairs.filter(([h]) => h === hash).map(([, friction]) => friction.toFixed(1)));
  visit.findings.check('a hash has one friction', pairs.length > 2 && pairs.every(([hash]) => frictions(hash).size === 1), JSON.stringify(pairs));
  await say({ type: 'pinswitch-set', values: { nonsense: 1 } });
  await say({ type: 'something-else', values: { 'layout.pins': [1] } });
  const frame = visit.page.frames()[1];
  visit.findings.check('?embed leaves the header out', await frame.$eval('header', (e) => !e.checkVisibility()));
  await frame.evaluate(() => { heardBy = window; postMessage({ type: 'pinswitch-set', values: { 'layout.pins': [1] } }, '*'); }).catch(() => {});
  visit.findings.check('the page itself, or another, sets nothing', !(await frame.evaluate(() => location.hash)).includes('layout.pins=1&'));
}

// The file is followed while others edit it, and written when asked: comments stay.
export async function followedFile(visit, site, { anotherView }) {
  if (site.file) return;
  const own = await anotherView('followed.toml', '# Mine.\n[layout]\npins = [5, 8, 11] # three\n');
  try {
    await visit.open(own.address);
    await visit.focus('[data-groove="5"]');
    await visit.page.keyboard.press('ArrowRight');
    await visit.page.keyboard.press('Space');
    await visit.addressHas('layout.pins=5,6,8,11');
    await visit.settled();
    await visit.click('#save');
    await visit.check('saving is told', () => /Saved to followed\.toml/.test(document.querySelector('#said').textContent));
    const text = readFileSync(own.followed, 'utf8');
    visit.findings.check('values are written back, comments stay', text === '# Mine.\n[layout]\npins = [5, 6, 8, 11] # three\n', text);
    writeFileSync(own.followed, text.replace('[5, 6, 8, 11]', '[6, 10]'));
    await visit.addressHas('layout.pins=6,10');
    await visit.settled();
    await visit.click('#undo');
    await visit.addressHas('layout.pins=5,6,8,11');
    await visit.settled();
    visit.findings.check('no error was caught by the page while it followed', (await visit.page.$eval('body', (b) => b.dataset.errors)) === '0');
  } finally {
    // The page is left first: it waits for the next change of the file, and would tell that the server went.
    await visit.page.goto('about:blank');
    await own.end();
  }
}
