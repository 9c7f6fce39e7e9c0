// What is not as it should be: each says what, and what now, and the rest of the page works.

import { Browser, Visit } from './drive.mjs';
import { START } from './design.mjs';

const FILES = {
  'a picture': ['holiday.png', 'PNG', /of no kind that this page reads/],
  'a packed table': ['plateaus.csv', 'PK\u0003\u0004\u0000\u0000', /holds no text/],
  'an empty file': ['plateaus.csv', '', /is empty/],
  'a table of 50 MB': ['huge.csv', 50e6, /50\.0 MB.*under 20 MB.*pinswitch/s],
  'a configuration of 2 MB': ['huge.toml', 2e6, /no configuration of pinswitch/],
  'a configuration that is none': ['broken.toml', '[shell\nwall', /could not be opened/],
  'a configuration with an unknown field': ['broken.toml', '[shell]\nwal_mm = 3\n', /could not be opened.*wal_mm/s],
};

export async function foreignFiles(visit, site) {
  await visit.open(site.address + START);
  for (const [kind, [name, content, words]] of Object.entries(FILES)) {
    await visit.drop(name, content);
    const says = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
    await visit.check(`${kind} is refused with what it is and what now`, says, words.source);
  }
  await visit.drop('some.csv', 'a,b\n1,2\n');
  await visit.check('a table of something else is refused in words', () => /some\.csv/.test(document.querySelector('#verdict .error')?.textContent ?? ''));
  await visit.addressHas('layout.pins=4,8,12');
  await visit.drop('mine.toml', '[layout]\npins = [6, 10]\n');
  await visit.addressHas('layout.pins=6,10');
  await visit.settled();
}

// An address that is pasted into the open page, and what of it cannot be taken.
export async function oddAddresses(visit, site) {
  await visit.open(site.address + START);
  const paste = (hash) => visit.page.evaluate((to) => { location.hash = to; }, hash);
  const says = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
  await paste('#nonsense');
  await visit.check('an address without a design leaves the design', says, 'holds no design.*stays as it was');
  await visit.addressHas('layout.pins=4,8,12');
  await paste('#v=1&layout.pins&ask.threshold_n=5,6&shell.walls');
  await visit.check('names without a value are told whole', says, 'names shell\\.walls,.*gives layout\\.pins, ask\\.threshold_n a value that cannot be');
  await visit.addressLacks('ask.threshold_n');
  await visit.settled();
  await visit.click('#undo');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.check('what was said of an address goes with it', () => document.querySelector('#notice').hidden);
  await visit.settled();
}

export async function moduleThatDoesNotLoad(visit, site) {
  if (!site.file) return;
  const words = { 'cut.html': /engine does not start in this browser.*pinswitch view/s, 'none.html': /holds no engine.*pinswitch view/s };
  visit.allowed.push(/404/);
  for (const [path, pattern] of Object.entries(words)) {
    await visit.open(site.address + path, { settles: false });
    await visit.check(`${path} says that there is no engine, and what now`, (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent), pattern.source);
  }
}

// A browser without WebGL: the rest of the page works.
export async function withoutWebgl(visit, site, { tools, executable, findings }) {
  const browser = await Browser.start({ tools, executable, flags: ['--disable-3d-apis'] });
  const bare = await Visit.begin(browser, { findings });
  try {
    await bare.open(site.address + START);
    await bare.check('without WebGL the page says so', () => /no WebGL/.test(document.querySelector('#view').textContent) && document.body.dataset.still === 'true');
    await bare.click('#mirror-pins');
    await bare.focus('[data-groove="4"]');
    await bare.page.keyboard.press('Delete');
    await bare.addressHas('layout.pins=8,12');
    await bare.settled();
    findings.check('without WebGL there is a curve', (await bare.text('#friction-words')).includes('of load'));
    await bare.end();
  } finally {
    await browser.end();
  }
}

// The server is ended while the page is open.
export async function serverGone(visit, site, { anotherView }) {
  if (site.file) return;
  const own = await anotherView('gone.toml');
  visit.allowed.push(/ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|ERR_INCOMPLETE/);
  await visit.open(own.address + START);
  const words = await visit.text('#friction-words');
  await own.end();
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.check('a server that is gone is told', () => /does not answer.*pinswitch view/s.test(document.querySelector('#notice').textContent));
  visit.findings.check('the last design stays', await visit.text('#friction-words') === words);
  await visit.addressHas('silicone.thickness_mm=3');
}
