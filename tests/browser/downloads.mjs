// Downloads equal the files of the command line, byte for byte.

import { execFile } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { inflateRawSync } from 'node:zlib';

// Twelve configurations with different parts, as addresses.
export const CONFIGURATIONS = [
  'layout.pins=5,8,11&switch.name=three', 'layout.pins=3,5,7,9,11,13&switch.name=six', 'layout.pins=&switch.name=bare', 'layout.pins=8&switch.name=one',
  'layout.pins=4,8,12&layout.substrate=abs&switch.name=rigid', 'layout.pins=5,8,11&fasteners.kind=insert&switch.name=inserts', 'layout.pins=5,8,11&mould.kind=one-piece&switch.name=tray',
  'layout.pins=5,8,11&mount.kind=flange&switch.name=flange', 'layout.pins=5,8,11&mount.kind=joint&switch.name=joint', 'layout.pins=2,3,14&silicone.thickness_mm=3.5&switch.name=uneven',
  'layout.pins=5,8,11&mesh.chord_tolerance_mm=0.05&label.text=A-1&switch.name=coarse', 'layout.pins=6,10&shell.outer_radius_mm=30&friction.points=21&switch.name=large',
];

const hash = (bytes) => createHash('sha256').update(bytes).digest('hex');

// The files of a ZIP archive by name, from its central directory.
function unpacked(archive) {
  const end = archive.lastIndexOf(Buffer.from([0x50, 0x4b, 5, 6]));
  const files = new Map();
  let offset = archive.readUInt32LE(end + 16);
  for (let i = archive.readUInt16LE(end + 10); i > 0; i -= 1) {
    const [method, packed, name, extra, comment, local] = [archive.readUInt16LE(offset + 10), archive.readUInt32LE(offset + 20), archive.readUInt16LE(offset + 28),
      archive.readUInt16LE(offset + 30), archive.readUInt16LE(offset + 32), archive.readUInt32LE(offset + 42)];
    const start = local + 30 + archive.readUInt16LE(local + 26) + archive.readUInt16LE(local + 28);
    const content = archive.subarray(start, start + packed);
    files.set(archive.toString('utf8', offset + 46, offset + 46 + name), method === 8 ? inflateRawSync(content) : content);
    offset += 46 + name + extra + comment;
  }
  return files;
}

// Directs the downloads of a visit to a folder; returns a function that waits for one of them.
async function downloading(visit, folder) {
  const session = await visit.browser.real.target().createCDPSession();
  await session.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: folder, browserContextId: visit.context.id });
  return async (name) => {
    const path = join(folder, name);
    for (const until = Date.now() + 60_000; Date.now() < until;) {
      if (existsSync(path) && !readdirSync(folder).some((f) => f.endsWith('.crdownload'))) {
        const bytes = readFileSync(path);
        rmSync(path);
        return bytes;
      }
      await new Promise((done) => setTimeout(done, 20));
    }
    throw new Error(`${name} was not downloaded`);
  };
}

// Hashes of the files that the command line generates from a downloaded configuration, once for
// both engines.
const generatedSets = new Map();
function byCommandLine(binary, scratch, name, toml) {
  const key = hash(toml);
  if (!generatedSets.has(key)) generatedSets.set(key, generated(binary, mkdtempSync(join(scratch, 'set-')), name, toml));
  return generatedSets.get(key);
}

async function generated(binary, folder, name, toml, options = []) {
  writeFileSync(join(folder, `${name}.toml`), toml);
  await promisify(execFile)(binary, ['-q', 'generate', `${name}.toml`, '--format', 'all', '--out', '.', ...options], { cwd: folder });
  const files = new Map(readdirSync(folder).map((file) => [file, hash(readFileSync(join(folder, file)))]));
  rmSync(folder, { recursive: true });
  return files;
}

// Opens the page with a configuration, or changes the address of the open page.
async function show(visit, site, configuration, name) {
  if (visit.page.url().startsWith('about:')) await visit.open(`${site.address}#v=1&${configuration}`);
  else await visit.page.evaluate((hash) => { location.hash = hash; }, `v=1&${configuration}`);
  await visit.page.waitForFunction((now) => document.querySelector('#name').textContent === now && document.body.dataset.pending === 'false', {}, name);
}

export async function downloads(visit, site, { binary, scratch, findings }) {
  const folder = join(scratch, `downloads-${site.name}`);
  mkdirSync(folder);
  const wait = await downloading(visit, folder);
  for (const [i, configuration] of CONFIGURATIONS.entries()) {
    const name = /switch\.name=(\w+)/.exec(configuration)[1];
    await show(visit, site, configuration, name);
    await visit.click('#download');
    await visit.page.waitForSelector('#file-list button', { timeout: 60_000 });
    await visit.click('#toml');
    const toml = await wait(`${name}.toml`);
    await visit.click('#zip');
    const files = unpacked(await wait(`${name}.zip`));
    const line = await byCommandLine(binary, scratch, name, toml);
    const own = new Map([...files].map(([file, bytes]) => [file, hash(bytes)]));
    const differ = [...new Set([...line.keys(), ...own.keys()])].filter((file) => line.get(file) !== own.get(file));
    findings.check(`the files of ${name} have the names of the command line's files`, own.size > 20 && [...line.keys()].every((file) => own.has(file)), [...own.keys()]);
    findings.check(`${own.size} files of ${name} equal those of the command line`, differ.length === 0, differ.join(' '));
    await compareBeds(visit, JSON.parse(files.get('manifest.json').toString()).plates, name);
    if (i === 0) await oneByOne(visit, wait, own, findings);
    await visit.click('#files-close');
  }
}

// The beds on the page equal the plates in the files.
async function compareBeds(visit, plates, name) {
  const drawn = await visit.page.$$eval('#bed svg', (beds) => beds.map((bed) => {
    const side = Number(bed.querySelector('.plate').getAttribute('width'));
    return [...bed.querySelectorAll('.outline')].map((outline) => {
      const [x, y, width, height] = ['x', 'y', 'width', 'height'].map((of) => Number(outline.getAttribute(of)));
      return [x + width / 2, side - y - height / 2];
    });
  }));
  const contains = (positions, { x_mm, y_mm }) => positions.some(([x, y]) => Math.hypot(x - x_mm, y - y_mm) < 0.05);
  const agree = drawn.length === plates.length && plates.every((plate, k) => plate.parts.length === drawn[k].length && plate.parts.every((part) => contains(drawn[k], part)));
  visit.findings.check(`the parts of ${name} are arranged as in its files`, agree, JSON.stringify([drawn, plates]));
}

// Also with a calibrated model.
export async function downloadsWithAModel(visit, site, { binary, scratch, findings, table }) {
  const folder = join(scratch, `modelled-${site.name}`);
  mkdirSync(folder);
  const wait = await downloading(visit, folder);
  const rig = mkdtempSync(join(scratch, 'rig-'));
  writeFileSync(join(rig, 'plateaus.csv'), table);
  await promisify(execFile)(binary, ['-q', 'calibrate', 'plateaus.csv', '--out', 'rig'], { cwd: rig });
  const model = join(rig, 'rig', 'model.toml');
  await visit.open(`${site.address}#v=1&layout.pins=4,9,12&silicone.thickness_mm=2.5&switch.name=modelled`);
  await visit.drop('model.toml', readFileSync(model, 'utf8'));
  await visit.check('the design uses the model', () => /your model/.test(document.querySelector('#trust').textContent));
  await visit.settled();
  await visit.click('#download');
  await visit.page.waitForSelector('#file-list button', { timeout: 60_000 });
  await visit.click('#toml');
  const toml = await wait('modelled.toml');
  await visit.click('#zip');
  const own = new Map([...unpacked(await wait('modelled.zip'))].map(([file, bytes]) => [file, hash(bytes)]));
  const line = await generated(binary, mkdtempSync(join(scratch, 'set-')), 'modelled', toml, ['--model', model]);
  const differ = [...new Set([...line.keys(), ...own.keys()])].filter((file) => line.get(file) !== own.get(file));
  findings.check(`${own.size} files with a model equal those of the command line`, own.size > 20 && differ.length === 0, differ.join(' '));
  await visit.click('#files-close');
  // If the model does not cover the first design, the published design shown instead does not name
  // it.
  const address = await visit.page.evaluate(() => location.hash);
  await visit.page.goto('about:blank');
  await visit.open(`${site.address}${address}&segment.grooves=14`);
  await visit.check('a published curve is not attributed to the model', () => !document.querySelector('#trouble').hidden && !/your model/.test(document.querySelector('#trust').textContent));
}

// Chromium drops downloads beyond ten a second.
const DOWNLOAD_INTERVAL_MS = 110;

// Files one by one equal those of the archive.
async function oneByOne(visit, wait, archive, findings) {
  await visit.page.$$eval('#file-list details', (all) => all.forEach((group) => { group.open = true; }));
  const buttons = await visit.page.$$('#file-list button');
  const differ = [];
  for (const button of buttons) {
    const name = await button.evaluate((b) => b.firstChild.textContent);
    await button.click();
    await new Promise((done) => setTimeout(done, DOWNLOAD_INTERVAL_MS));
    if (hash(await wait(name)) !== archive.get(name)) differ.push(name);
  }
  findings.check('files one by one equal those of the archive', differ.length === 0 && buttons.length === archive.size, `${buttons.length} of ${archive.size}, ${differ.join(' ')}`);
}
