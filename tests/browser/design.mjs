// Pins, templates, every kind of control, undo, the address, and the comparison of curves.

export const START = '#v=1&layout.pins=4,8,12';

const dot = (groove) => `[data-groove="${groove}"] .dot`;
const checked = (groove) => `[data-groove="${groove}"][aria-checked="true"]`;

async function middle(visit, selector) {
  const element = await visit.page.waitForSelector(selector);
  await element.evaluate((e) => e.scrollIntoView({ block: 'center' }));
  const { x, y, width, height } = await element.boundingBox();
  return [x + width / 2, y + height / 2];
}

async function drag(visit, from, to) {
  const { mouse } = visit.page;
  await mouse.move(...from);
  await mouse.down();
  await mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  await mouse.move(...to);
  await mouse.up();
}

export async function pinsByMouse(visit, site) {
  await visit.open(site.address + START);
  await visit.page.mouse.click(...await middle(visit, dot(9)));
  await visit.addressHas('layout.pins=4,8,9,12');
  await visit.page.mouse.click(...await middle(visit, dot(8)));
  await visit.addressHas('layout.pins=4,9,12');
  await drag(visit, await middle(visit, dot(9)), await middle(visit, dot(7)));
  await visit.addressHas('layout.pins=4,7,12');
  await drag(visit, await middle(visit, dot(7)), await middle(visit, dot(12)));
  await visit.addressHas('layout.pins=4,7,12');
  await visit.click('#mirror-pins');
  await visit.addressHas('layout.pins=4,9,12');
  await visit.settled();
  await visit.check('the drawing has the pins', (pin) => document.querySelector(pin) !== null, checked(9));
  await visit.click('#clear-pins');
  await visit.check('a layout without pins is named', () => document.querySelector('#pins-title').textContent === 'No pins');
  await visit.settled();
}

export async function pinsByKeys(visit, site) {
  await visit.open(site.address + START);
  const { keyboard } = visit.page;
  await visit.focus('[data-groove="4"]');
  await keyboard.press('ArrowRight');
  await keyboard.press('Space');
  await visit.addressHas('layout.pins=4,5,8,12');
  await keyboard.down('Shift');
  await keyboard.press('ArrowRight');
  await keyboard.press('ArrowRight');
  await keyboard.press('ArrowRight');
  await keyboard.up('Shift');
  await visit.addressHas('layout.pins=4,8,9,12');
  await visit.check('the focus follows the pin', () => document.activeElement.dataset.groove === '9');
  await keyboard.press('Delete');
  await visit.addressHas('layout.pins=4,8,12');
  await keyboard.press('Home');
  await keyboard.press('Enter');
  await visit.addressHas('layout.pins=1,4,8,12');
  await keyboard.press('Tab');
  await visit.check('all grooves are one tab stop', () => !document.activeElement.dataset.groove);
  await visit.settled();
}

export async function templates(visit, site) {
  await visit.open(site.address + START);
  const names = await visit.page.$$eval('#chips button', (chips) => chips.map((c) => c.textContent));
  visit.findings.check('published layouts have buttons', ['three-double', 'six-single'].every((n) => names.includes(n)), names);
  await visit.click(`#chips button:nth-child(${names.indexOf('six-single') + 1})`);
  await visit.settled();
  await visit.check('the template is shown', () => document.querySelector('#name').textContent === 'six-single' && document.querySelector('#chips [aria-pressed=true]').textContent === 'six-single');
  await visit.click('#more > summary');
  await visit.page.waitForSelector('#template-list .thumb');
  const pictures = await visit.page.$$eval('#template-list .template:has(.strip)', (all) => all.map((item) => ({
    name: item.querySelector('b').textContent, pins: item.querySelectorAll('.pin').length, curve: item.querySelector('.thumb')?.getAttribute('aria-label') ?? '' })));
  const picture = (name) => pictures.find((p) => p.name === name) ?? {};
  visit.findings.check('every switch has a picture with its pins and its curve', pictures.length >= 5 && pictures.every((p) => /N of friction at .* N, (switches at .* N|does not switch)$/.test(p.curve)), JSON.stringify(pictures));
  visit.findings.check('the pins are those of the layout', picture('six-single').pins === 6 && picture('silicone-only').pins === 0, JSON.stringify(pictures));
  const printer = await visit.page.evaluateHandle(() => [...document.querySelectorAll('#template-list button')].find((b) => b.textContent.startsWith('printer-')));
  await printer.click();
  await visit.settled();
  await visit.check('a printer changes the settings, not the layout', () => location.hash.includes('print.') && document.querySelector('#name').textContent.startsWith('six-single'));
}

export async function parameters(visit, site, { facts }) {
  await visit.open(site.address + START);
  const shown = await visit.page.$$eval('#fields .field', (fields) => fields.length);
  visit.findings.check('every field of the table has a control', shown === facts.fields.length, `${shown} of ${facts.fields.length}`);
  const unnamed = await visit.page.$$eval('#fields input, #fields select', (all) => all.filter((e) => !e.labels?.length && !e.getAttribute('aria-label')).map((e) => e.id));
  visit.findings.check('every control has a name', unnamed.length === 0, unnamed);
  await visit.type('#f-silicone-thickness_mm', '2.5');
  await visit.addressHas('silicone.thickness_mm=2.5');
  await visit.settled();
  await visit.page.$eval('#f-silicone-thickness_mm-field input[type=range]', (e) => { e.value = 700; e.dispatchEvent(new Event('input', { bubbles: true })); });
  await visit.addressLacks('silicone.thickness_mm=2.5');
  await visit.addressHas('silicone.thickness_mm=');
  await visit.click('#f-silicone-thickness_mm-field [aria-label^="Reset"]');
  await visit.addressLacks('silicone.thickness_mm');
  await visit.click('#f-silicone-thickness_mm-field [aria-label^="About"]');
  await visit.check('reason, range, default and origin are shown', () => /Range: .*Default: .*(published|chosen|assumed)/.test(document.querySelector('#f-silicone-thickness_mm-about').textContent));
  await visit.type('#find', 'engrave');
  await visit.check('a search narrows the list', () => [...document.querySelectorAll('#fields .field')].filter((f) => f.checkVisibility()).length < 8);
  await visit.click('#f-label-engrave');
  await visit.addressHas('label.engrave=');
  await visit.type('#find', ' ');
  await visit.click('#only-changed');
  await visit.check('only changed parameters are shown', () => [...document.querySelectorAll('#fields .field')].filter((f) => f.checkVisibility()).length === 2);
  await visit.click('#only-changed');
  await visit.page.$eval('#f-fasteners-kind', (e) => { e.closest('details').open = true; });
  await visit.page.select('#f-fasteners-kind', 'insert');
  await visit.addressHas('fasteners.kind=insert');
  await visit.settled();
}

export async function outOfBounds(visit, site) {
  await visit.open(site.address + START);
  const before = await visit.text('#friction-text');
  await visit.type('#f-segment-grooves', '40');
  await visit.check('the error is shown at the control', () => !document.querySelector('#f-segment-grooves-error').hidden && document.querySelector('#f-segment-grooves').getAttribute('aria-invalid') === 'true');
  await visit.settled();
  await visit.check('it is shown above the view, too, with help', () => /lower it to|raise/.test(document.querySelector('#trouble').textContent));
  const fixes = await visit.page.$$eval('#trouble .fix', (all) => all.map((b) => b.textContent));
  visit.findings.check('fixes that keep the number of grooves come before the one that takes it back', fixes.length > 1 && !/grooves to/.test(fixes[0]) && /grooves to/.test(fixes.at(-1)), fixes.join('; '));
  visit.findings.check('the last valid design is shown in grey', await visit.text('#friction-text') === before && await visit.page.$eval('body', (b) => b.classList.contains('stale')));
  await visit.click('#download');
  await visit.check('a refused design has no files, with a message', () => /cannot be built/.test(document.querySelector('#files-status').textContent) && document.querySelector('#zip').disabled);
  await visit.click('#files-close');
  await visit.click('#f-segment-grooves-error .fix');
  await visit.settled();
  await visit.addressHas('segment.grooves=40');
  await visit.check('its button fixes it', () => document.querySelector('#trouble').hidden && !document.body.classList.contains('stale') && document.querySelector('#f-segment-grooves-error').hidden);
  await visit.type('#f-shell-wall_mm', '1e9');
  await visit.check('a value out of its range is reported', () => /to|range|most/.test(document.querySelector('#f-shell-wall_mm-error').textContent));
  await visit.settled();
  await visit.click('#f-shell-wall_mm-error .fix');
  await visit.addressHas('shell.wall_mm=60');
  await visit.settled();
  await visit.click('#f-shell-wall_mm-error .fix');
  await visit.settled();
  await visit.check('the largest value is kept, and others follow', () => document.querySelector('#trouble').hidden && Number(document.querySelector('#f-shell-wall_mm').value) === 60);
  await visit.type('#f-segment-grooves', '7.5');
  await visit.check('a fraction is reported at once', () => document.querySelector('#f-segment-grooves-error').textContent === 'Enter a whole number.');
}

export async function errorUnderAFilter(visit, site) {
  await visit.open(site.address + START);
  const isShown = () => document.querySelector('#f-segment-grooves-error').checkVisibility() && document.querySelector('#f-segment-grooves').checkVisibility();
  const isHidden = () => !document.querySelector('#f-segment-grooves').checkVisibility();
  await visit.type('#find', 'engrave');
  await visit.check('other fields are hidden', isHidden);
  await visit.page.evaluate(() => { location.hash += '&segment.grooves=40'; });
  await visit.check('a field with an error is shown under any filter', isShown);
  await visit.settled();
  await visit.click('#trouble .fix');
  await visit.check('once fixed, it is hidden again', isHidden);
  await visit.settled();
}

export async function undoAndRedo(visit, site) {
  await visit.open(site.address + START);
  visit.findings.check('at first there is nothing to undo', await visit.page.$eval('#undo', (b) => b.disabled) && await visit.page.$eval('#redo', (b) => b.disabled));
  await visit.click('#mirror-pins');
  await visit.focus('[data-groove="4"]');
  await visit.page.keyboard.press('Delete');
  await visit.addressHas('layout.pins=8,12');
  await visit.type('#f-silicone-thickness_mm', '3');
  await visit.addressHas('silicone.thickness_mm=3');
  await visit.click('#undo');
  await visit.addressLacks('silicone.thickness_mm');
  await visit.click('#undo');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.click('#redo');
  await visit.addressHas('layout.pins=8,12');
  await visit.focus('#share');
  await visit.page.keyboard.down('Control');
  await visit.page.keyboard.press('z');
  await visit.addressHas('layout.pins=4,8,12');
  await visit.page.keyboard.press('y');
  await visit.page.keyboard.up('Control');
  await visit.addressHas('layout.pins=8,12');
  await visit.settled();
}

// Each pin is one step of the history, however quickly they follow each other.
export async function undoOfQuickPins(visit, site) {
  await visit.open(`${site.address}#v=1&layout.pins=8`);
  for (const groove of [3, 6, 12]) {
    await visit.focus(`[data-groove="${groove}"]`);
    await visit.page.keyboard.press('Space');
  }
  await visit.addressHas('layout.pins=3,6,8,12');
  for (const before of ['3,6,8', '3,8', '8']) {
    await visit.click('#undo');
    await visit.addressHas(`layout.pins=${before}`);
  }
  await visit.check('then there is nothing to undo', () => document.querySelector('#undo').disabled);
  await visit.settled();
}

export async function undoOfTargets(visit, site) {
  await visit.open(site.address + START);
  const undo = async () => {
    await visit.page.keyboard.down('Control');
    await visit.page.keyboard.press('z');
    await visit.page.keyboard.up('Control');
  };
  await visit.type('#target-threshold', '24');
  await visit.addressHas('targets.threshold_n=24');
  await undo();
  await visit.addressLacks('targets.threshold_n');
  visit.findings.check('the input of a removed target is empty', await visit.page.$eval('#target-threshold', (e) => e.value === ''));
  await visit.click('#add-friction');
  await visit.addressHas('targets.friction=');
  const before = await visit.page.$eval('#target-frictions input', (e) => e.value);
  await visit.type('#target-frictions input', '8.25');
  await visit.addressHas('8.25');
  await undo();
  await visit.check('undo restores a target friction', (value) => document.querySelector('#target-frictions input').value === value, before);
  await visit.settled();
}

export async function address(visit, site) {
  const hash = '#v=1&layout.pins=3,8,13&label.text=a%20b%2Cc&silicone.thickness_mm=2.5&targets.threshold_n=24&targets.friction=40:8.5';
  await visit.open(site.address + hash);
  await visit.page.reload();
  await visit.settled();
  for (const part of ['layout.pins=3,8,13', 'label.text=a b,c', 'silicone.thickness_mm=2.5', 'targets.threshold_n=24', 'targets.friction=40:8.5']) await visit.addressHas(part);
  visit.findings.check('a complete address gives no message', !(await visit.shown('#notice')), await visit.text('#notice'));
  await visit.page.goto(`${site.address}#v=1&layout.pins=7,9`);
  await visit.addressHas('layout.pins=7,9');
  await visit.addressLacks('thickness_mm');
  await visit.settled();
  // Without an address the page continues with the last visit.
  if (site.name === 'module') {
    await visit.open(site.address);
    await visit.addressHas('layout.pins=7,9');
  }
}

// The page reads its own address again, with the same error.
export async function reloadOfRefusedValues(visit, site) {
  for (const [box, text, part] of [['#f-layout-pins', '0, 4, -3, 8', 'layout.pins=-3,0,4,8'], ['#f-layout-pins', '4, 12345678901', 'layout.pins=4,12345678901'], ['#f-silicone-thickness_mm', '1e-9', 'silicone.thickness_mm=1e-9'],
    ['#f-segment-grooves', '-2', 'segment.grooves=-2']]) {
    await visit.open(site.address + START);
    await visit.type(box, text);
    await visit.addressHas(part);
    await visit.settled();
    const message = await visit.text(`${box}-error`);
    await visit.page.reload();
    await visit.settled();
    await visit.addressHas(part);
    visit.findings.check(`${text} has the same error after a reload`, message !== '' && await visit.text(`${box}-error`) === message && await visit.shown(`${box}-error`), message);
    visit.findings.check('and no other message', !await visit.shown('#notice'), await visit.text('#notice'));
  }
}

const LINKS = {
  'that is cut off': ['#layout.pi', /contains no design, or is cut off/], 'without names': ['#%%%', /contains no design/], 'of a later version': ['#v=9&layout.pins=6,10', /version 9, newer/],
  'of an invalid version': ['#v=0&layout.pins=6,10', /version 0/],
  'with an unknown field': ['#v=1&shell.colour=red&layout.pins=6,10', /Unknown in the address: shell\.colour\..*rest is applied/s],
  'with a value of the wrong kind': ['#v=1&shell.wall_mm=thick&layout.pins=6,10', /Invalid value in the address: shell\.wall_mm\..*rest is applied/s],
  'with a truncated model': ['#v=1&layout.pins=6,10&model=mine.toml~eJyrVkrL', /model in the address is cut off/],
  'with a value out of its range': ['#v=1&shell.wall_mm=1e9', /shell|wall/i],
};

export async function links(visit, site) {
  for (const [kind, [hash, pattern]] of Object.entries(LINKS)) {
    await visit.open(site.address + hash);
    const message = await visit.text('#notice') + await visit.text('#trouble');
    visit.findings.check(`a link ${kind} is explained`, pattern.test(message), message);
    visit.findings.check(`after a link ${kind} a design is shown`, Number(await visit.page.$eval('body', (b) => b.dataset.generation)) > 0);
    if (/layout.pins/.test(hash)) await visit.addressHas('layout.pins=6,10');
  }
}

export async function compare(visit, site) {
  await visit.open(site.address + START);
  const legend = () => visit.text('#legend');
  await visit.click('#keep-curve');
  visit.findings.check('the comparison is in the legend', (await legend()).includes('comparison: '), await legend());
  await visit.type('#f-silicone-thickness_mm', '5');
  await visit.settled();
  const both = await visit.picture('#chart');
  visit.findings.check('it is shown next to the changed design, with the difference', /4, 8, 12\], thickness 2 mm/.test(await legend()), await legend());
  await visit.page.reload();
  await visit.settled();
  visit.findings.check('it survives a reload', (await legend()).includes('4, 8, 12'));
  await visit.click('#keep-curve');
  visit.findings.check('it can be cleared', !(await legend()).includes('comparison: ') && await visit.picture('#chart') !== both);
  await visit.click('#other-laws');
  visit.findings.check('other laws are drawn on request', /layout|paper/.test(await legend()), await legend());
}
