// The page inside another page, and the file that `pinswitch view` follows.

import { readFileSync, writeFileSync } from 'node:fs';
import { START } from './design.mjs';

// A site can be framed; the server refuses it, since its page can write a file.
export async function embedded(visit, site) {
  if (!site.file) {
    await visit.open(`${site.address}?embed${START}`);
    visit.findings.check('?embed hides the header', !(await visit.shown('header')));
    return;
  }
  await visit.open(`${site.origin}/around.html`, { settles: false });
  const hears = (what, condition, ...given) => visit.check(what, condition, ...given);
  await hears('the surrounding page receives the first design', () => heard.some((m) => m.type === 'pinswitch-state' && m.version === 1 && m.friction_n > 0));
  await hears('a message at the load event of the frame applies', () => heard.some((m) => String(m.values?.['layout.pins']) === '2,8,14'));
  const send = (message) => visit.page.evaluate((m) => { heard.length = 0; frames[0].postMessage(m, '*'); }, message);
  await send({ type: 'pinswitch-set', values: { 'layout.pins': [3, 8, 13] } });
  await hears('values apply, and the state is sent', () => heard.some((m) => String(m.values?.['layout.pins']) === '3,8,13' && m.hash.includes('layout.pins=3,8,13')));
  await send({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9' });
  await hears('an address applies', () => heard.some((m) => String(m.values?.['layout.pins']) === '7,9' && m.trust));
  await send({ type: 'pinswitch-set', values: { 'segment.grooves': 40 } });
  await hears('a refusal is sent as text', () => heard.some((m) => /segment\.grooves/.test(m.trouble)));
  await send({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9' });
  await hears('the design is shown again', () => heard.some((m) => m.hash === '#v=1&layout.pins=7,9' && m.trust && !m.trouble));
  await send({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7,9&targets.threshold_n=25&nonsense=1' });
  await hears('targets are sent, with the ignored part', () => heard.some((m) => m.hash.includes('targets.threshold_n=25') && /nonsense/.test(m.said) && m.trust));
  await send({ type: 'pinswitch-set', hash: '#' });
  await hears('an empty address is reported', () => heard.some((m) => /neither an address/.test(m.said)));
  await send({ type: 'pinswitch-set', hash: '#section' });
  await hears('an address without a design is reported', () => heard.some((m) => /contains no design/.test(m.said)));
  await send({ type: 'pinswitch-set', values: { 'layout.pins': [4, 11] } });
  await hears('a state has only its own messages', () => heard.some((m) => m.hash.includes('layout.pins=4,11') && m.said === null));
  // A model takes time to decode; the later message applies nevertheless.
  const long = await visit.page.frames()[1].evaluate(async () => (await packModel('slow', Array.from({ length: 4000 }, (_, i) => `# ${Math.sin(i)}`).join('\n'))).packed);
  await visit.page.evaluate((hash) => {
    heard.length = 0;
    frames[0].postMessage({ type: 'pinswitch-set', hash }, '*');
    frames[0].postMessage({ type: 'pinswitch-set', hash: '#v=1&layout.pins=7' }, '*');
  }, `#v=1&layout.pins=2,3&model=${long}`);
  await hears('the later of two messages applies', () => heard.at(-1)?.hash === '#v=1&layout.pins=7');
  for (const [what, message] of [['a message without content', {}], ['a number as address', { hash: 5 }], ['a list as values', { values: [] }], ['half a surrogate pair', { values: { 'label.text': '\ud800' } }]]) {
    await send({ type: 'pinswitch-set', ...message });
    await hears(`${what} is reported`, () => heard.some((m) => /neither an address nor valid values/.test(m.said)));
  }
  await send({ type: 'pinswitch-set', values: { 'layout.pins=3&x': 1 } });
  await hears('a name cannot extend the address', () => heard.some((m) => /Unknown in the address: layout/.test(m.said) && !/pins=3&/.test(m.hash)));
  // Many changes in a row: each friction belongs to the layout that is sent with it.
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
  visit.findings.check('each address has one friction', pairs.length > 2 && pairs.every(([hash]) => frictions(hash).size === 1), JSON.stringify(pairs));
  await send({ type: 'pinswitch-set', values: { nonsense: 1 } });
  await send({ type: 'something-else', values: { 'layout.pins': [1] } });
  const frame = visit.page.frames()[1];
  visit.findings.check('?embed hides the header', await frame.$eval('header', (e) => !e.checkVisibility()));
  await frame.evaluate(() => { heardBy = window; postMessage({ type: 'pinswitch-set', values: { 'layout.pins': [1] } }, '*'); }).catch(() => {});
  visit.findings.check('messages of other windows are ignored', !(await frame.evaluate(() => location.hash)).includes('layout.pins=1&'));
}

// The file is followed, and written on request; comments are kept.
export async function followedFile(visit, site, { anotherView }) {
  if (site.file) return;
  const view = await anotherView('followed.toml', '# Mine.\n[layout]\npins = [5, 8, 11] # three\n');
  try {
    await visit.open(view.address);
    await visit.focus('[data-groove="5"]');
    await visit.page.keyboard.press('ArrowRight');
    await visit.page.keyboard.press('Space');
    await visit.addressHas('layout.pins=5,6,8,11');
    await visit.settled();
    await visit.click('#save');
    await visit.check('saving is reported', () => /Saved to followed\.toml/.test(document.querySelector('#toast').textContent));
    const text = readFileSync(view.followed, 'utf8');
    visit.findings.check('values are written, comments are kept', text === '# Mine.\n[layout]\npins = [5, 6, 8, 11] # three\n', text);
    writeFileSync(view.followed, text.replace('[5, 6, 8, 11]', '[6, 10]'));
    await visit.addressHas('layout.pins=6,10');
    await visit.settled();
    await visit.click('#undo');
    await visit.addressHas('layout.pins=5,6,8,11');
    await visit.settled();
    visit.findings.check('following causes no error', (await visit.page.$eval('body', (b) => b.dataset.errors)) === '0');
  } finally {
    // The page is left first: it waits for the next change, and would report the missing server.
    await visit.page.goto('about:blank');
    await view.end();
  }
}

// A published page names a manifest with which a browser installs it.
export async function installable(visit, site) {
  await visit.open(site.address);
  const client = await visit.page.createCDPSession();
  const { url, errors, data } = await client.send('Page.getAppManifest');
  await client.detach();
  if (!site.file) { visit.findings.check('a served page is not an app', !url, url); return; }
  const manifest = JSON.parse(data);
  visit.findings.check('the manifest has no error', errors.length === 0, JSON.stringify(errors));
  visit.findings.check('it starts the page at its own address', manifest.start_url === site.address && manifest.display === 'standalone', manifest.start_url);
  const shows = await visit.page.evaluate((src) => new Promise((done) => {
    const image = new Image();
    image.onload = () => done(image.naturalWidth > 0);
    image.onerror = () => done(false);
    image.src = src;
  }), manifest.icons[0].src);
  visit.findings.check('its icon is a picture', shows);
  const obstacles = await visit.page.createCDPSession().then(async (session) => (await session.send('Page.getInstallabilityErrors')).installabilityErrors);
  const real = obstacles.filter(({ errorId }) => errorId !== 'in-incognito');
  visit.findings.check('nothing hinders the installation', real.length === 0, JSON.stringify(real));
}
