// Invalid input and failures: the page reports the problem and what to do, and the rest of it
// works.

import { Browser, Visit } from './driver.mjs';
import { START } from './design.mjs';

const FILES = {
  'a picture': ['holiday.png', 'PNG', /unknown type/],
  'a packed table': ['plateaus.csv', 'PK\u0003\u0004\u0000\u0000', /is not a text file/],
  'an empty file': ['plateaus.csv', '', /is empty/],
  'a table of 50 MB': ['huge.csv', 50e6, /50\.0 MB.*at most 20 MB.*pinswitch segment/s],
  'a configuration of 2 MB': ['huge.toml', 2e6, /not a pinswitch configuration/],
  'invalid TOML': ['broken.toml', '[shell\nwall', /Cannot open broken\.toml/],
  'a sweep': ['many.toml', '[sweep]\nbase = "three-double"\n', /Cannot open many\.toml.*a sweep.*pinswitch batch many\.toml/s],
  'a file of effects': ['mine.toml', 'schema = "pinswitch.effects/1"\n[[effect]]\nid = "a"\n', /calibrate TABLE --effects mine\.toml/],
  'a configuration with an unknown field': ['broken.toml', '[shell]\nwal_mm = 3\n', /Cannot open broken\.toml.*wal_mm/s],
};

export async function foreignFiles(visit, site) {
  await visit.open(site.address + START);
  for (const [kind, [name, content, pattern]] of Object.entries(FILES)) {
    await visit.drop(name, content);
    const hasNotice = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
    await visit.check(`${kind} is refused with problem and help`, hasNotice, pattern.source);
  }
  await visit.drop('some.csv', 'a,b\n1,2\n');
  await visit.check('another table is refused by name', () => /some\.csv/.test(document.querySelector('#verdict .error')?.textContent ?? ''));
  await visit.addressHas('layout.pins=4,8,12');
  await visit.drop('mine.toml', '[layout]\npins = [6, 10]\n');
  await visit.addressHas('layout.pins=6,10');
  await visit.settled();
}

// The message about a refused design covers only the picture, and moves nothing.
export async function refusalCoversNothing(visit, site, { pictures }) {
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
    visit.findings.check(`a refusal moves nothing at ${width} px`, moved.length === 0, JSON.stringify(moved));
    for (const down of [0, 120, 250]) {
      const covered = await visit.page.evaluate((y) => {
        scrollTo(0, y);
        const a = document.querySelector('#trouble').getBoundingClientRect();
        return ['#name', '.intro', '#view-tools', '.head', '#chart'].filter((s) => {
          const b = document.querySelector(s).getBoundingClientRect();
          return a.right > b.left + 1 && a.left < b.right - 1 && a.bottom > b.top + 1 && a.top < b.bottom - 1;
        });
      }, down);
      visit.findings.check(`a refusal covers nothing at ${width} px, scrolled by ${down} px`, covered.length === 0, covered.join(' '));
    }
    // Wherever the page is scrolled, the message is in view.
    for (let down = 300; down <= 1200; down += 50) {
      const hidden = await visit.page.evaluate(async (y) => {
        scrollTo(0, y);
        await new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); });
        const { left, top, bottom } = document.querySelector('#trouble').getBoundingClientRect();
        return top < 0 || bottom > innerHeight || document.elementFromPoint(left + 20, top + 8)?.closest('#trouble') === null ? `${top} to ${bottom}` : '';
      }, down);
      visit.findings.check(`a refusal is in view at ${width} px, scrolled by ${down} px`, hidden === '', hidden);
    }
    await visit.page.evaluate(() => scrollTo(0, 0));
    await visit.page.screenshot({ path: `${pictures}/${site.name}-trouble-${width}.png` });
  }
}

export async function firstVisitWithAnInvalidDesign(visit, site) {
  await visit.open(`${site.address}#v=1&segment.grooves=40`);
  await visit.check('the design shown instead is named', () => /three-double is shown in grey instead/.test(document.querySelector('#trouble').textContent));
  await visit.click('#trouble .fix');
  await visit.settled();
  await visit.type('#f-segment-grooves', '59');
  await visit.check('later the last valid design is shown', () => /The last valid design is shown in grey/.test(document.querySelector('#trouble').textContent));
  await visit.settled();
}

// Invalid addresses that are pasted into the open page.
export async function invalidAddresses(visit, site) {
  await visit.open(site.address + START);
  const paste = (hash) => visit.page.evaluate((to) => { location.hash = to; }, hash);
  const hasNotice = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
  await paste('#nonsense');
  await visit.check('an address without a design changes nothing', hasNotice, 'contains no design.*design is unchanged');
  await visit.addressHas('layout.pins=4,8,12');
  await paste('#v=1&layout.pins&targets.threshold_n=5,6&shell.walls');
  await visit.check('names without a value are reported', hasNotice, 'Unknown in the address: shell\\.walls\\..*Invalid value in the address: layout\\.pins, targets\\.threshold_n\\.');
  await visit.addressLacks('targets.threshold_n');
  await visit.settled();
  await visit.click('#undo');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.check('undo removes the messages of the address', () => document.querySelector('#notice').hidden);
  await visit.settled();
}

// The skip link does not change the design, and names of JavaScript objects are not values.
export async function skipLinkAndReservedNames(visit, site) {
  await visit.open(site.address + START);
  await visit.focus('.skip');
  await visit.page.keyboard.press('Enter');
  await visit.check('the skip link moves the focus to the design', () => document.activeElement.id === 'main');
  visit.findings.check('without a notice', await visit.page.$eval('#notice', (e) => e.hidden) && (await visit.page.evaluate(() => location.hash)).startsWith('#v=1'));
  for (const name of ['constructor', 'toString', '__proto__', 'hasOwnProperty']) {
    await visit.page.evaluate((flag) => { location.hash = `#v=1&layout.pins=4,8,12&parts.proxy=${flag}`; }, name);
    await visit.check(`${name} is not a flag`, () => /Invalid value in the address: parts\.proxy/.test(document.querySelector('#notice').textContent) && !/proxy/.test(location.hash));
  }
  await visit.settled();
}

// Messages about a file, and errors of the pins, are visible wherever the page is scrolled.
export async function visibleMessages(visit, site) {
  const isVisible = (selector) => { const box = document.querySelector(selector).getBoundingClientRect(); return box.height > 0 && box.top >= 0 && box.bottom <= innerHeight; };
  for (const [width, height] of [[375, 812], [820, 1180], [1440, 900]]) {
    await visit.look(width, height, false);
    await visit.open(site.address + START);
    await visit.page.$eval('#choose-table', (e) => e.scrollIntoView({ block: 'end' }));
    await visit.drop('packed.csv', 'PK\u0003\u0004\u0000\u0000');
    await visit.check(`${width}: a refusal is visible where the file was chosen`, isVisible, '#notice');
    await visit.click('#download');
    await visit.drop('holiday.png', 'PNG');
    await visit.check(`${width}: and not behind the dialog of files`, () => !document.querySelector('#files').open && /holiday/.test(document.querySelector('#notice').textContent));
    await visit.page.$eval('#notice button', (e) => e.click());
    await visit.page.evaluate(() => { location.hash = '#v=1&layout.substrate=abs&layout.pins='; });
    await visit.page.waitForSelector('#pins-error:not([hidden])');
    await visit.page.$eval('#pins-title', (e) => e.scrollIntoView({ block: 'center' }));
    await visit.check(`${width}: an error of the pins is visible next to them`, isVisible, '#pins-error');
  }
}

export async function moduleThatDoesNotLoad(visit, site) {
  if (!site.file) return;
  const patterns = { 'cut.html': /engine does not start in this browser.*pinswitch view/s, 'none.html': /contains no engine.*pinswitch view/s };
  visit.allowed.push(/404/);
  for (const [path, pattern] of Object.entries(patterns)) {
    await visit.open(site.address + path, { settles: false });
    await visit.check(`${path} reports the missing engine, with help`, (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent), pattern.source);
  }
}

// A browser without WebGL: the rest of the page works.
export async function withoutWebgl(visit, site, { tools, executable, findings }) {
  const browser = await Browser.start({ tools, executable, flags: ['--disable-3d-apis'] });
  const bare = await Visit.begin(browser, { findings });
  try {
    await bare.open(site.address + START);
    await bare.check('missing WebGL is reported', () => /no WebGL/.test(document.querySelector('#view').textContent) && document.body.dataset.noWebgl === 'true');
    await bare.check('a picture of the parts is shown', () => document.querySelector('#view img')?.naturalWidth > 300);
    const { src } = await bare.page.$eval('#view img', (e) => ({ src: e.src }));
    await bare.click('#mirror-pins');
    await bare.focus('[data-groove="4"]');
    await bare.page.keyboard.press('Delete');
    await bare.addressHas('layout.pins=8,12');
    await bare.settled();
    await bare.check('the picture follows the design', (before) => document.querySelector('#view img').src !== before, src);
    findings.check('without WebGL there is a curve', (await bare.text('#friction-text')).includes('of load'));
    await bare.end();
  } finally {
    await browser.end();
  }
}

// The server ends while the page is open.
export async function serverGone(visit, site, { anotherView }) {
  if (site.file) return;
  const view = await anotherView('gone.toml');
  visit.allowed.push(/ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|ERR_INCOMPLETE/);
  await visit.open(view.address + START);
  const friction = await visit.text('#friction-text');
  await view.end();
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.check('the missing server is reported', () => /does not answer.*pinswitch view/s.test(document.querySelector('#notice').textContent));
  visit.findings.check('the last design is still shown', await visit.text('#friction-text') === friction);
  await visit.addressHas('silicone.thickness_mm=3');
}

// The page starts with any content of its storage.
export async function damagedStorage(visit, site) {
  for (const entry of ['{"kept":{"name":"a","values":{},"curve":{}}}', '{"hash":5}', '{', '[]', 'null', '{"kept":7,"hash":null}']) {
    await visit.open(site.address);
    await visit.page.evaluate((text) => localStorage.setItem('pinswitch.configurator.1', text), entry);
    await visit.open(site.address);
    visit.findings.check(`the page starts with ${entry} in its storage`, await visit.page.$eval('body', (b) => b.dataset.errors === '0'));
  }
}
