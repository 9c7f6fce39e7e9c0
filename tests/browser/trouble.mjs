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
  'a sweep': ['many.toml', '[sweep]\nbase = "three-double"\n', /many\.toml could not be opened.*a sweep.*pinswitch batch many\.toml/s],
  'a file of effects': ['mine.toml', 'schema = "pinswitch.effects/1"\n[[effect]]\nid = "a"\n', /calibrate TABLE --effects mine\.toml/],
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

// What is said of a design that cannot be built covers none of what is shown in its stead, and moves nothing.
export async function troubleCoversNothing(visit, site, { pictures }) {
  for (const [width, height] of [[375, 812], [820, 1180], [1440, 900]]) {
    await visit.look(width, height, false);
    await visit.open(site.address + START);
    const places = () => visit.page.evaluate(() => ['#name', '.intro', '#view-tools', '.head', '#chart', '#pins'].map((s) => {
      const { left, top, right, bottom } = document.querySelector(s).getBoundingClientRect();
      return { s, left, top: top + scrollY, right, bottom: bottom + scrollY };
    }));
    const before = await places();
    await visit.page.evaluate((hash) => { location.hash = hash; }, `${START}&segment.grooves=40`);
    await visit.page.waitForSelector('#trouble:not([hidden])');
    await visit.settled();
    await visit.page.evaluate(() => scrollTo(0, 0));
    const moved = (await places()).filter((now, i) => Math.abs(now.top - before[i].top) + Math.abs(now.bottom - before[i].bottom) > 1);
    visit.findings.check(`trouble moves nothing at ${width} px`, moved.length === 0, JSON.stringify(moved));
    for (const down of [0, 120, 250, 400]) {
      const covered = await visit.page.evaluate((y) => {
        scrollTo(0, y);
        const a = document.querySelector('#trouble').getBoundingClientRect();
        return ['#name', '.intro', '#view-tools', '.head', '#chart'].filter((s) => {
          const b = document.querySelector(s).getBoundingClientRect();
          return a.right > b.left + 1 && a.left < b.right - 1 && a.bottom > b.top + 1 && a.top < b.bottom - 1;
        });
      }, down);
      visit.findings.check(`trouble covers nothing at ${width} px, ${down} px down`, covered.length === 0, covered.join(' '));
    }
    await visit.page.evaluate(() => scrollTo(0, 0));
    await visit.page.screenshot({ path: `${pictures}/${site.name}-trouble-${width}.png` });
  }
}

export async function firstVisitByALinkThatCannotBe(visit, site) {
  await visit.open(`${site.address}#v=1&segment.grooves=40`);
  await visit.check('what is shown instead is named', () => /In its place three-double is shown/.test(document.querySelector('#trouble').textContent));
  await visit.click('#trouble .mend');
  await visit.settled();
  await visit.type('#f-segment-grooves', '40');
  await visit.check('later it is the last design that could be', () => /The last design that can stays/.test(document.querySelector('#trouble').textContent));
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

// The way past the parameters is none into another design, and names of the language are no values.
export async function wordsThatAreNoValues(visit, site) {
  await visit.open(site.address + START);
  await visit.focus('.skip');
  await visit.page.keyboard.press('Enter');
  await visit.check('the way past the parameters leads to the design', () => document.activeElement.id === 'main');
  visit.findings.check('and raises no alarm', await visit.page.$eval('#notice', (e) => e.hidden) && (await visit.page.evaluate(() => location.hash)).startsWith('#v=1'));
  for (const word of ['constructor', 'toString', '__proto__', 'hasOwnProperty']) {
    await visit.page.evaluate((flag) => { location.hash = `#v=1&layout.pins=4,8,12&parts.proxy=${flag}`; }, word);
    await visit.check(`${word} is no flag`, () => /parts\.proxy a value that cannot be/.test(document.querySelector('#notice').textContent) && !/proxy/.test(location.hash));
  }
  await visit.settled();
}

// What is said of a file is seen where the person is who chose it, and so is what is wrong with the pins.
export async function toldWhereOneIs(visit, site) {
  const isSeen = (selector) => { const box = document.querySelector(selector).getBoundingClientRect(); return box.height > 0 && box.top >= 0 && box.bottom <= innerHeight; };
  for (const [width, height] of [[375, 812], [820, 1180], [1440, 900]]) {
    await visit.look(width, height, false);
    await visit.open(site.address + START);
    await visit.page.$eval('#choose-table', (e) => e.scrollIntoView({ block: 'end' }));
    await visit.drop('packed.csv', 'PK\u0003\u0004\u0000\u0000');
    await visit.check(`${width}: a refusal is seen where the file was chosen`, isSeen, '#notice');
    await visit.click('#download');
    await visit.drop('holiday.png', 'PNG');
    await visit.check(`${width}: and not behind the files`, () => !document.querySelector('#files').open && /holiday/.test(document.querySelector('#notice').textContent));
    await visit.page.$eval('#notice button', (e) => e.click());
    await visit.page.evaluate(() => { location.hash = '#v=1&layout.substrate=abs&layout.pins='; });
    await visit.page.waitForSelector('#pins-error:not([hidden])');
    await visit.page.$eval('#pins-say', (e) => e.scrollIntoView({ block: 'center' }));
    await visit.check(`${width}: what is wrong with the pins stands beside them`, isSeen, '#pins-error');
  }
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
    await bare.check('a picture of the parts stands there', () => document.querySelector('#view img')?.naturalWidth > 300);
    const { src } = await bare.page.$eval('#view img', (e) => ({ src: e.src }));
    await bare.click('#mirror-pins');
    await bare.focus('[data-groove="4"]');
    await bare.page.keyboard.press('Delete');
    await bare.addressHas('layout.pins=8,12');
    await bare.settled();
    await bare.check('it is that of the design', (before) => document.querySelector('#view img').src !== before, src);
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

// Whatever lies in the store, by an earlier version or by somebody's hand: the page begins.
export async function damagedStore(visit, site) {
  for (const left of ['{"kept":{"name":"a","values":{},"curve":{}}}', '{"hash":5}', '{', '[]', 'null', '{"kept":7,"hash":null}']) {
    await visit.open(site.address);
    await visit.page.evaluate((text) => localStorage.setItem('pinswitch.configurator.1', text), left);
    await visit.open(site.address);
    visit.findings.check(`a page begins with ${left} in its store`, await visit.page.$eval('body', (b) => b.dataset.errors === '0'));
  }
}
