// The report of a set: the same page, read only, with its answers inside.

import { execFile } from 'node:child_process';
import { readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { Browser, Visit } from './driver.mjs';

const WIDTHS = { phone: [375, 812], tablet: [820, 1180], desk: [1440, 900] };
// Binary STL: a head, then a normal of three numbers, three corners and two bytes per triangle.
const STL = { head: 84, triangle: 50, normal: 12 };

// Splits binary STL into its bytes without normals, and its normals.
function splitStl(bytes) {
  const rest = [bytes.subarray(0, STL.head)];
  const normals = [];
  for (let at = STL.head; at < bytes.length; at += STL.triangle) {
    for (let k = 0; k < STL.normal; k += 4) normals.push(bytes.readFloatLE(at + k));
    rest.push(bytes.subarray(at + STL.normal, at + STL.triangle));
  }
  return [Buffer.concat(rest), normals];
}

// Makes a set; returns its folder and the address of its report.
async function made({ binary, scratch, findings }, name, options = []) {
  const folder = join(scratch, name);
  await promisify(execFile)(binary, ['-q', 'generate', 'three-double', ...options, '--out', folder]);
  const bytes = statSync(join(folder, 'report.html')).size;
  findings.check('a report has less than 1.5 MB', bytes < 1.5e6, `${name}: ${bytes}`);
  return { folder, address: `file://${join(folder, 'report.html')}` };
}

// One report is enough: it has neither server nor module.
const isFirst = (site) => !site.file;

export async function reportIsReadOnly(visit, site, shared) {
  if (!isFirst(site)) return;
  const { address } = await made(shared, 'read-only');
  await visit.open(address);
  visit.findings.check('its title is the name of the set', await visit.page.title() === 'three-double: friction switch');
  visit.findings.check('the heading of the curve is its name', await visit.text('#curve-title') === 'Friction over load', await visit.text('#curve-title'));
  const shown = await visit.page.evaluate(() => [...document.querySelectorAll('input, select, button, [tabindex="0"], [role=slider]')].filter((e) => e.checkVisibility() && !e.closest('[inert]')).map((e) => e.id || e.className));
  const expected = ['download', 'explode', 'section', 'trust', 'load', 'other-laws', 'download-here', 'parts'];
  visit.findings.check('nothing can be changed', JSON.stringify(shown) === JSON.stringify(expected), shown.join(' '));
  const friction = await visit.text('#friction-text');
  await visit.page.evaluate(() => { location.hash = '#v=1&layout.pins=2,14'; });
  await visit.drop('other.toml', '[layout]\npins = [3]\n');
  await visit.check('a dropped configuration is refused, with the way out', () => /pinswitch view/.test(document.querySelector('#notice').textContent));
  await visit.page.keyboard.down('Control');
  await visit.page.keyboard.press('z');
  await visit.page.keyboard.up('Control');
  visit.findings.check('an address, a file and keys change nothing', await visit.text('#friction-text') === friction && await visit.text('#pins-title') === 'Pins in 5, 8, 11');
  visit.findings.check('nothing is kept for the next visit', await visit.page.evaluate(() => { try { return !(localStorage.getItem('pinswitch.configurator.1') ?? '').includes('hash'); } catch { return true; } }));
  await visit.slide('#load', 10);
  visit.findings.check('the load changes the friction', await visit.text('#friction-text') !== friction);
  const before = await visit.picture('#view');
  await visit.slide('#explode', 1);
  visit.findings.check('the view explodes', await visit.picture('#view') !== before);
  const filled = await visit.page.evaluate(() => ['#checks li, #passed-list li', '#materials dt', '#parts tbody tr', '#bed svg .outline'].map((s) => document.querySelectorAll(s).length));
  visit.findings.check('checks, bill, parts and bed are filled', filled.every((n) => n > 2), filled);
}

export async function reportSavesItsFiles(visit, site, shared) {
  if (!isFirst(site)) return;
  const { folder, address } = await made(shared, 'saved');
  await visit.open(address);
  await visit.page.evaluate(() => {
    window.saved = new Map();
    // What a click on a link of the page saves.
    URL.createObjectURL = (blob) => { window.last = blob; return 'blob:none'; };
    HTMLAnchorElement.prototype.click = function click() { window.saved.set(this.download, window.last); };
  });
  await visit.click('#download');
  await visit.page.waitForSelector('#file-list a, #file-list button', { visible: true });
  const offered = await visit.page.$$eval('#file-list a, #file-list button', (all) => all.map((e) => [e.firstChild.textContent, e.tagName]));
  const files = readdirSync(folder).filter((name) => !name.startsWith('.') && name !== 'report.html').sort();
  visit.findings.check('every file of the set is offered', JSON.stringify(offered.map(([name]) => name).sort()) === JSON.stringify(files), offered.map(([name]) => name).join(' '));
  visit.findings.check('links say where their files are', await visit.shown('#beside'));
  for (const name of ['shell.stl', 'support-left.stl', 'friction.csv', 'assembly.png']) {
    const isButton = offered.some(([offer, tag]) => offer === name && tag === 'BUTTON');
    visit.findings.check(`${name} is in the page`, isButton);
    await visit.page.$$eval('#file-list button', (all, wanted) => all.find((e) => e.firstChild.textContent === wanted)?.click(), name);
    await visit.check(`${name} is saved`, (wanted) => window.saved.has(wanted), name);
    const base64 = await visit.page.evaluate(async (wanted) => base64Of(new Uint8Array(await window.saved.get(wanted).arrayBuffer())), name);
    let [saved, expected] = [Buffer.from(base64, 'base64'), readFileSync(join(folder, name))];
    if (name.endsWith('.stl')) {
      const [[ours, normals], [theirs, exact]] = [saved, expected].map(splitStl);
      const worst = Math.max(...normals.map((n, i) => Math.abs(n - exact[i])));
      visit.findings.check(`the normals of ${name} are those of the set`, worst < 1e-3, worst);
      [saved, expected] = [ours, theirs];
    }
    visit.findings.check(`${name} equals the file of the set`, saved.equals(expected), `${saved.length} and ${expected.length} bytes`);
  }
}

export async function reportAtEachWidth(visit, site, shared) {
  if (!isFirst(site)) return;
  const { pictures } = shared;
  const { address } = await made(shared, 'widths');
  for (const [name, [width, height]] of Object.entries(WIDTHS)) {
    for (const dark of [false, true]) {
      await visit.look(width, height, dark);
      await visit.open(address);
      const wide = await visit.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      visit.findings.check(`the report fits a width of ${width}`, wide <= 0, wide);
      await visit.picture('#view');
      await visit.page.screenshot({ path: `${pictures}/report-${name}${dark ? '-dark' : ''}.png`, fullPage: true });
    }
  }
  // Cards of one row are about as high as each other: no empty columns.
  const empty = await visit.page.evaluate(() => [...document.querySelectorAll('.card')].filter((e) => e.checkVisibility()).map((e) => {
    const last = Math.max(...[...e.children].map((c) => c.getBoundingClientRect().bottom));
    return [e.className, e.getBoundingClientRect().bottom - last];
  }).filter(([, px]) => px > 150));
  visit.findings.check('no card is mostly empty', empty.length === 0, JSON.stringify(empty));
  await visit.page.evaluate(visit.browser.axeText);
  const faults = await visit.page.evaluate(async () => (await axe.run()).violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target).join(' ')}`));
  visit.findings.check('axe finds nothing', faults.length === 0, faults.join('; '));
  await visit.page.emulateMediaType('print');
  const printed = await visit.page.evaluate(() => ['#view', '#chart', '#materials', '#parts', '#pins'].filter((s) => document.querySelector(s).getBoundingClientRect().height < 100));
  visit.findings.check('view, curve, bill and parts are printed', printed.length === 0, printed.join(' '));
  await visit.page.screenshot({ path: `${pictures}/report-print.png`, fullPage: true });
  await visit.page.emulateMediaType(null);
}

// Without WebGL, without scripts, and with a script of someone else.
export async function reportElsewhere(visit, site, shared) {
  if (!isFirst(site)) return;
  const { tools, executable, findings } = shared;
  const { folder, address } = await made(shared, 'elsewhere', ['--set', 'mount.kind=joint']);
  await visit.open(address);
  await visit.slide('#flexion', 40);
  visit.findings.check('a joint turns', (await visit.text('#flexion-value')).startsWith('40°'));
  const inserted = join(folder, 'inserted.html');
  writeFileSync(inserted, readFileSync(join(folder, 'report.html'), 'utf8').replace('</body>', '<script>document.title = "inserted";</script></body>'));
  visit.allowed.push(/Content Security Policy|Content-Security-Policy/);
  await visit.open(`file://${inserted}`);
  visit.findings.check('an inserted script does not run', await visit.page.title() === 'three-double: friction switch');
  const browser = await Browser.start({ tools, executable, flags: ['--disable-3d-apis'] });
  const bare = await Visit.begin(browser, { findings });
  try {
    await bare.open(address);
    await bare.check('without WebGL there is a picture', () => document.querySelector('#view img')?.naturalWidth > 300);
    findings.check('and the curve', (await bare.text('#friction-text')).includes('of load'));
    await bare.page.setJavaScriptEnabled(false);
    await bare.page.goto(address);
    findings.check('without scripts there is a picture, too', await bare.page.$eval('#still', (e) => e.getBoundingClientRect().width > 100));
    await bare.page.setJavaScriptEnabled(true);
    await bare.end();
  } finally {
    await browser.end();
  }
}
