// The configuration of `pinswitch view`: the page starts with it and writes its file.

import { readFileSync, readlinkSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { START } from './design.mjs';

// Ends a view after `act`. The page is left first: it would report the missing server.
async function during(visit, view, act) {
  try {
    await act(view);
  } finally {
    await visit.page.goto('about:blank');
    await view.end();
  }
}

const hasNotice = (source) => new RegExp(source, 's').test(document.querySelector('#notice').textContent);
const hasSaved = (file) => document.querySelector('#toast').textContent.includes(`Saved to ${file}`);

async function clickInNotice(visit, label) {
  await (await visit.page.evaluateHandle((text) => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === text), label)).click();
}

export async function templateOfTheCommandLine(visit, site, { startView }) {
  if (site.file) return;
  await during(visit, await startView(['six-single', '--set', 'shell.width_mm=13']), async (view) => {
    await visit.open(view.address);
    await visit.addressHas('shell.width_mm=13');
    await visit.check('the page has the pins of the template', () => document.querySelectorAll('[data-groove][aria-checked="true"], [data-groove][aria-pressed="true"]').length === 6);
    visit.findings.check('and no Save button', !(await visit.shown('#save')));
  });
}

export async function symlinkedFile(visit, site, { startView, scratch }) {
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
    await visit.check('saving is reported', hasSaved, 'link.toml');
    visit.findings.check('the link is still a link', readlinkSync(join(scratch, 'link.toml')) === 'behind.toml');
    const now = readFileSync(join(scratch, 'behind.toml'), 'utf8');
    visit.findings.check('its file has the value and keeps lines, comments and line ends', now === text.replace('  8,\r\n', '  8,\r\n  10,\r\n'), now);
  });
}

export async function missingFile(visit, site, { startView, scratch }) {
  if (site.file) return;
  const file = join(scratch, 'gone.toml');
  writeFileSync(file, '[layout]\npins = [5, 8]\n');
  await during(visit, await startView(['gone.toml']), async (view) => {
    await visit.open(view.address);
    rmSync(file);
    await visit.check('a missing file is reported', hasNotice, 'gone.toml: the file is missing');
    await visit.click('#save');
    await visit.check('saving asks before it creates the file', hasNotice, 'Not saved: gone\\.toml does not exist any more');
    await clickInNotice(visit, 'Create it');
    await visit.check('on request it is created', hasSaved, 'gone.toml');
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
    await visit.check('saving is reported', hasSaved, 'under.toml');
    visit.findings.check('only the changed value is written', readFileSync(file, 'utf8') === '[layout]\npins = [5, 8, 11]\n', readFileSync(file, 'utf8'));
    await visit.type('#f-shell-width_mm', '12');
    await visit.settled();
    await visit.click('#save');
    await visit.check('a value that an option overrides is reported', hasNotice, 'override width: restart it without --set');
    visit.findings.check('and is in the file', readFileSync(file, 'utf8').includes('width_mm = 12.0'), readFileSync(file, 'utf8'));
    await visit.settled();
  });
}

export async function packageCannotBeSaved(visit, site, { startView, scratch, binary }) {
  if (site.file) return;
  execFileSync(binary, ['generate', 'three-double', '--format', '3mf'], { cwd: scratch, stdio: 'ignore' });
  await during(visit, await startView(['out/three-double/assembly.3mf']), async (view) => {
    await visit.open(view.address);
    visit.findings.check('a 3MF has no Save button', !(await visit.shown('#save')));
    await visit.open(view.address + START);
  });
}
