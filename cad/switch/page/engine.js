// Requests to the engine: a worker with the module in the page, the server of the page, or the recorded answers of a report.

// A request was not answered; the message is for the user. `kind` is `failed`, `trap`, `gone` or
// `refused`.
class EngineError extends Error {
  constructor(message, kind) { super(message); this.kind = kind; }
}
// A request was replaced by a newer one, or stopped.
class Superseded extends Error {}

// A worker that answers one request at a time, in order. Of waiting requests with the same `group`
// only the last is kept.
class WorkerClient {
  constructor(source, module) {
    this.source = source;
    this.module = module;
    this.waiting = [];
    this.current = null;
  }

  start() {
    const address = URL.createObjectURL(new Blob([this.source], { type: 'text/javascript' }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = (event) => this.receive(event.data);
    this.worker.onerror = (event) => { event.preventDefault(); this.receive({ failed: event.message ?? '' }); };
    this.worker.postMessage(this.module());
  }

  request(request, group) {
    return new Promise((resolve, reject) => {
      if (group) {
        this.waiting.filter((r) => r.group === group).forEach((r) => r.reject(new Superseded()));
        this.waiting = this.waiting.filter((r) => r.group !== group);
      }
      this.waiting.push({ request, group, resolve, reject });
      this.next();
    });
  }

  next() {
    if (this.current || !this.waiting.length) return;
    if (!this.worker) this.start();
    this.current = this.waiting.shift();
    this.worker.postMessage({ request: JSON.stringify(this.current.request) });
  }

  receive(message) {
    if (message.failed !== undefined || message.trap !== undefined) {
      this.end();
      const hasFailed = message.failed !== undefined;
      this.current?.reject(new EngineError(hasFailed ? TEXT.engineFailed(message.failed) : TEXT.engineStopped, hasFailed ? 'failed' : 'trap'));
    } else if (message.bytes) {
      this.current?.resolve(message.bytes);
    } else {
      this.current?.resolve(JSON.parse(message.json));
    }
    this.current = null;
    this.next();
  }

  // Ends the worker and its computation; the next request starts another worker.
  end() { this.worker?.terminate(); this.worker = null; }

  // Stops requests of this kind, waiting or in progress, and no others.
  stop(kind) {
    this.waiting.filter((r) => r.request.command === kind).forEach((r) => r.reject(new Superseded()));
    this.waiting = this.waiting.filter((r) => r.request.command !== kind);
    if (this.current?.request.command !== kind) return;
    this.end();
    this.current.reject(new Superseded());
    this.current = null;
    this.next();
  }
}

// The server answers requests in parallel, but of one `group` one at a time and only the last that
// waits.
class ServerClient {
  constructor() { this.latest = {}; this.aborts = {}; }

  async request(request, group) {
    const number = group && (this.latest[group] = (this.latest[group] ?? 0) + 1);
    if (group) {
      await this.running?.catch(() => {});
      if (number !== this.latest[group]) throw new Superseded();
    }
    const answer = this.post(request);
    if (group) this.running = answer;
    return answer;
  }

  async post(request) {
    const { signal } = (this.aborts[request.command] ??= new AbortController());
    let response;
    try {
      response = await fetch('answer', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(request), signal });
    } catch {
      if (signal.aborted) throw new Superseded();
      throw new EngineError(location.protocol === 'file:' ? TEXT.engineMissing : TEXT.serverGone, 'gone');
    }
    const isJson = (response.headers.get('content-type') ?? '').includes('json');
    if (!response.ok && !isJson) throw new EngineError(response.status === 404 ? TEXT.engineMissing : TEXT.engineStatus(response.status), 'gone');
    return isJson ? response.json() : response.arrayBuffer();
  }

  stop(kind) { this.aborts[kind]?.abort(); delete this.aborts[kind]; }
}

class Engine {
  constructor() {
    this.inProgress = new Set();
    if (IS_REPORT) {
      this.designs = this.slow = new Recorded(byId('report').textContent);
      return;
    }
    const element = byId('module');
    const module = element.textContent.trim();
    // Texts of this page that the module needs, too, with their offsets in it, as
    // `three:OFFSET`.
    const texts = element.dataset.offsets.split(' ').filter(Boolean).map((entry) => entry.split(':')).map(([id, offset]) => [Number(offset), byId(id).textContent]);
    const client = () => (module ? new WorkerClient(byId('worker').textContent, () => ({ module: bytesOf(module).buffer, texts })) : new ServerClient());
    // Designs do not wait for requests that take seconds.
    this.designs = client();
    this.slow = client();
  }

  // The long request in progress, for which files wait: `search`, `calibrate`, or undefined.
  longRequest() { return [...this.inProgress].map((request) => request.command).find((kind) => kind === 'search' || kind === 'calibrate'); }

  // Returns the answer; throws EngineError if there is none, and Superseded if a newer design
  // replaces this one. A design with `extra` is neither replaced nor replaces others.
  async request({ extra, ...request }) {
    const isSlow = ['search', 'files', 'file', 'zip', 'calibrate', 'experiment'].includes(request.command);
    const group = request.command === 'design' && !extra ? 'design' : undefined;
    this.inProgress.add(request);
    const answer = await (isSlow ? this.slow : this.designs).request(request, group).finally(() => this.inProgress.delete(request));
    if (answer?.error !== undefined) throw new EngineError(answer.error, 'refused');
    // Designs and opened files show a refusal at its field, slow requests in one line.
    if (isSlow && answer?.trouble) throw new EngineError(troubleText(answer.trouble), 'refused');
    return answer;
  }

  stop(kind) { this.slow.stop(kind); }
}
