// Origins of the page: a folder behind a plain file server, or `pinswitch view`.

import { spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

// Serves texts by path without special headers, as any file server does.
export async function fileServer(files) {
  const server = createServer((request, response) => {
    const content = files[request.url.split(/[?#]/)[0]];
    response.writeHead(content === undefined ? 404 : 200, { 'content-type': 'text/html; charset=utf-8' });
    response.end(content ?? '');
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { origin: `http://127.0.0.1:${server.address().port}`, end: () => new Promise((done) => { server.closeAllConnections(); server.close(done); }) };
}

// The page of a site with its module, and copies with a damaged and without a module.
export async function moduleSite(folder) {
  const page = readFileSync(join(folder, 'index.html'), 'utf8');
  const inModule = (change) => page.replace(/(<script type="text\/plain" id="module"[^>]*>)([^<]*)/, (_, tag, text) => tag + change(text));
  const surrounding = '<!doctype html><title>around</title><link rel="icon" href="data:,"><script>window.heard = []; addEventListener("message", (e) => heard.push(e.data));</script><iframe src="/?embed" width="1200" height="800" onload="this.contentWindow.postMessage({ type: \'pinswitch-set\', values: { \'layout.pins\': [2, 8, 14] } }, \'*\')"></iframe>';
  const server = await fileServer({ '/': page, '/cut.html': inModule((text) => text.slice(0, text.length / 2)), '/none.html': inModule(() => ''), '/around.html': surrounding });
  return { name: 'module', address: `${server.origin}/`, origin: server.origin, file: `file://${join(folder, 'index.html')}`, end: server.end };
}

// `pinswitch view` with these arguments; the first is the configuration.
export async function viewSite(binary, folder, [configuration, ...options]) {
  const child = spawn(binary, ['view', configuration, ...options, '--port', '0'], { cwd: folder, stdio: ['ignore', 'pipe', 'ignore'] });
  const lines = createInterface({ input: child.stdout });
  const origin = await new Promise((done, fail) => {
    lines.once('line', done);
    child.once('exit', (code) => fail(new Error(`pinswitch view ended with ${code}`)));
  });
  const ended = new Promise((done) => child.once('exit', done));
  return { name: 'server', address: `${origin}/`, origin, followed: join(folder, configuration), end: () => { child.kill(); return ended; } };
}
