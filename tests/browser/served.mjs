// What `pinswitch view` was started with: the page begins with it, and writes its file as it is.

import { readFileSync, readlinkSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { START } from './design.mjs';

// A view that was started with these arguments, for as long as `act` takes. The page is left first, since it would tell that
// the server went.
async function during(visit, view, act) {
  try {
    await act(view);
  } finally {
    await visit.page.goto('about:blank');
    await view.end();
  }
}

const notices = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
const savesTo = (file) => document.querySelector('#said').textContent.includes(`Saved to ${file}`);

async function act(visit, words) {
  await (await visit.page.evaluateHandle((text) => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === text), words)).click();
}

export async function templateOfTheCommandLine(visit, site, { startView }) {
  if (site.file) return;
  // A visit before, to be gone on with where nothing is named.
  await during(visit, await startView(['six-single', '--set', 'shell.width_mm=13']), async (view) => {
    await visit.open(view.address);
    await visit.addressHas('shell.width_mm=13');
    await visit.check('it has the pins of the template', () => document.querySelectorAll('[data-groove][aria-checked="true"], [data-groove][aria-pressed="true"]').length === 6);
    visit.findings.check('and offers to save nowhere', !(await visit.shown('#save')));
  });
}

export async function fromPageToPage(visit, site) {
  await visit.open(site.address + START);
  if (site.file) {
    visit.findings.check('a page without a server names no other page', !await visit.shown('#set-page'));
    return;
  }
  // The page of the set has no icon to ask for.
  visit.allowed.push(/404/);
  await visit.click('#set-page');
  await visit.check('the configurator leads to the page of the set', () => location.pathname === '/' && document.querySelector('#summary').textContent !== '');
  await visit.click('a[href="/configure"]');
  await visit.settled();
  visit.findings.check('which leads back', await visit.page.evaluate(() => location.pathname === '/configure'));
}

export async function fileBehindALink(visit, site, { startView, scratch }) {
  if (site.file) return;
  const text = '# Mine.\r\n[layout]\r\npins = [\r\n  5, # first\r\n  8,\r\n]\r\n# the end\r\n';
  writeFileSync(join(scratch, 'behind.toml'), text);
  symlinkSync('behind.toml', join(scratch, 'link.toml'));
  await during(visit, await startView(['link.toml']), async (view) => {
    await visit.open(view.address);
    await visit.focus('[data-groove="10"]');
    await visit.page.keyboard.press('Space');
    await visit.settled();
    await visit.click('#save');
    await visit.check('saving is told', savesTo, 'link.toml');
    visit.findings.check('the link stays one', readlinkSync(join(scratch, 'link.toml')) === 'behind.toml');
    const now = readFileSync(join(scratch, 'behind.toml'), 'utf8');
    visit.findings.check('its file has the value, its lines, comments and line ends', now === text.replace('  8,\r\n', '  8,\r\n  10,\r\n'), now);
  });
}

export async function fileThatWentAway(visit, site, { startView, scratch }) {
  if (site.file) return;
  const file = join(scratch, 'gone.toml');
  writeFileSync(file, '[layout]\npins = [5, 8]\n');
  await during(visit, await startView(['gone.toml']), async (view) => {
    await visit.open(view.address);
    rmSync(file);
    await visit.check('that it is gone is told', notices, 'gone.toml: the file is gone');
    await visit.click('#save');
    await visit.check('it is not written by itself', notices, 'was not saved: it is no longer there');
    await act(visit, 'Write it anew');
    await visit.check('asked for, it is', savesTo, 'gone.toml');
    visit.findings.check('with the values of the page', readFileSync(file, 'utf8') === '[layout]\npins = [5, 8]\n', readFileSync(file, 'utf8'));
    await visit.settled();
  });
}

export async function optionsOverTheFile(visit, site, { startView, scratch }) {
  if (site.file) return;
  const file = join(scratch, 'under.toml');
  writeFileSync(file, '[layout]\npins = [5, 8]\n');
  await during(visit, await startView(['under.toml', '--preset', 'printer-fff-0.4', '--set', 'shell.width_mm=13']), async (view) => {
    await visit.open(view.address);
    await visit.addressHas('shell.width_mm=13');
    await visit.focus('[data-groove="11"]');
    await visit.page.keyboard.press('Space');
    await visit.settled();
    await visit.click('#save');
    await visit.check('saving is told', savesTo, 'under.toml');
    visit.findings.check('only what was changed is in the file', readFileSync(file, 'utf8') === '[layout]\npins = [5, 8, 11]\n', readFileSync(file, 'utf8'));
    await visit.type('#f-shell-width_mm', '12');
    await visit.settled();
    await visit.click('#save');
    await visit.check('what an option hides is told', notices, 'says of width counts once pinswitch view is started without --set');
    visit.findings.check('and stands in the file', readFileSync(file, 'utf8').includes('width_mm = 12.0'), readFileSync(file, 'utf8'));
    await visit.settled();
  });
}

export async function packageWithoutAText(visit, site, { startView, scratch, binary }) {
  if (site.file) return;
  execFileSync(binary, ['generate', 'three-double', '--format', '3mf'], { cwd: scratch, stdio: 'ignore' });
  await during(visit, await startView(['out/three-double/assembly.3mf']), async (view) => {
    await visit.open(view.address);
    visit.findings.check('what cannot be saved offers no Save', !(await visit.shown('#save')));
    await visit.open(view.address + START);
  });
}
