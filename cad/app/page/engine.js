// Asks the engine: a worker with the module that the page holds, or the server that served the page.

// Answers of the engine that are no answers: told in words.
class EngineError extends Error {
  constructor(message, kind) { super(message); this.kind = kind; }
}
// A question that a newer one has made pointless.
class Stale extends Error {}

// One worker: answers one question at a time, in their order. Of questions with the same `newest` only the last waits.
class WorkerLane {
  constructor(source, module) {
    this.source = source;
    this.module = module;
    this.waiting = [];
    this.asked = null;
  }

  start() {
    const address = URL.createObjectURL(new Blob([this.source], { type: 'text/javascript' }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = (event) => this.answered(event.data);
    this.worker.onerror = (event) => { event.preventDefault(); this.answered({ fatal: event.message ?? '' }); };
    this.worker.postMessage(this.module());
  }

  ask(request, newest) {
    return new Promise((resolve, reject) => {
      if (newest) {
        this.waiting.filter((q) => q.newest === newest).forEach((q) => q.reject(new Stale()));
        this.waiting = this.waiting.filter((q) => q.newest !== newest);
      }
      this.waiting.push({ request, newest, resolve, reject });
      this.next();
    });
  }

  next() {
    if (this.asked || !this.waiting.length) return;
    if (!this.worker) this.start();
    this.asked = this.waiting.shift();
    this.worker.postMessage({ question: JSON.stringify(this.asked.request) });
  }

  answered(message) {
    if (message.fatal !== undefined || message.trap !== undefined) {
      this.end();
      const broken = message.fatal !== undefined;
      this.asked?.reject(new EngineError(broken ? WORDS.engineBroken(message.fatal) : WORDS.engineStopped, broken ? 'broken' : 'trap'));
    } else if (message.bytes) {
      this.asked?.resolve(message.bytes);
    } else {
      this.asked?.resolve(JSON.parse(message.json));
    }
    this.asked = null;
    this.next();
  }

  // Ends the worker with what it does; the next question starts another.
  end() { this.worker?.terminate(); this.worker = null; }

  // Ends questions of this kind, waiting or under way, and no others.
  stop(kind) {
    this.waiting.filter((q) => q.request.ask === kind).forEach((q) => q.reject(new Stale()));
    this.waiting = this.waiting.filter((q) => q.request.ask !== kind);
    if (this.asked?.request.ask !== kind) return;
    this.end();
    this.asked.reject(new Stale());
    this.asked = null;
    this.next();
  }
}

// The server answers many at once; here too only the newest design counts.
class ServerLane {
  constructor() { this.turn = {}; this.stopping = {}; }

  async ask(request, newest) {
    const turn = newest && (this.turn[newest] = (this.turn[newest] ?? 0) + 1);
    if (newest) {
      await this.running?.catch(() => {});
      if (turn !== this.turn[newest]) throw new Stale();
    }
    const answer = this.post(request);
    if (newest) this.running = answer;
    return answer;
  }

  async post(request) {
    const { signal } = (this.stopping[request.ask] ??= new AbortController());
    let response;
    try {
      response = await fetch('answer', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(request), signal });
    } catch {
      if (signal.aborted) throw new Stale();
      throw new EngineError(location.protocol === 'file:' ? WORDS.engineMissing : WORDS.serverGone, 'gone');
    }
    const isJson = (response.headers.get('content-type') ?? '').includes('json');
    if (!response.ok && !isJson) throw new EngineError(response.status === 404 ? WORDS.engineMissing : WORDS.enginePart(`${response.status}`), 'gone');
    return isJson ? response.json() : response.arrayBuffer();
  }

  stop(kind) { this.stopping[kind]?.abort(); delete this.stopping[kind]; }
}

class Engine {
  constructor() {
    const element = byId('module');
    const module = element.textContent.trim();
    // Libraries of this page that the module holds, too: left out of it, and put back where `three:PLACE` says.
    const holes = element.dataset.holes.split(' ').filter(Boolean).map((hole) => hole.split(':')).map(([id, place]) => [Number(place), byId(id).textContent]);
    const lane = () => (module ? new WorkerLane(byId('worker').textContent, () => ({ module: bytesOf(module).buffer, holes })) : new ServerLane());
    // What takes seconds has a lane of its own, so that pins still move.
    this.quick = lane();
    this.slow = lane();
    this.underWay = new Set();
  }

  // What of that which takes long is under way: `search`, `calibrate`, or nothing. Files are made behind it.
  busyWith() { return [...this.underWay].map((request) => request.ask).find((kind) => kind === 'search' || kind === 'calibrate'); }

  // The answer; an EngineError in words if there is none, Stale if a newer design was asked for meanwhile.
  async ask(request) {
    const isSlow = ['search', 'files', 'file', 'zip', 'calibrate'].includes(request.ask);
    const newest = request.ask === 'design' && !request.aside ? 'design' : undefined;
    const { aside: _, ...question } = request;
    this.underWay.add(request);
    const answer = await (isSlow ? this.slow : this.quick).ask(question, newest).finally(() => this.underWay.delete(request));
    if (answer?.error !== undefined) throw new EngineError(answer.error, 'refused');
    // Designs and files that were opened tell trouble at its field; what follows from a design says it in a line.
    if (isSlow && answer?.trouble) throw new EngineError(troubleWords(answer.trouble), 'refused');
    return answer;
  }

  stop(kind) { this.slow.stop(kind); }
}
