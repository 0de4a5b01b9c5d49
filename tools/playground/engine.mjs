// The worker with Python, from the files that the page has loaded. Of requests of a kind only the last waits.
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

/** The files as the worker takes them: WebAssembly is compiled once, also for the workers that follow. */
async function load() {
  while (!['python', 'library', 'lagc'].every(name => self.FILES?.[name]))
    await new Promise(next => setTimeout(next, 10));
  const { python, library, lagc } = self.FILES;
  self.FILES = null;
  const plain = new Blob([bytes(python)]).stream().pipeThrough(new DecompressionStream('gzip'));
  const module = await WebAssembly.compile(await new Response(plain).arrayBuffer());
  return { python: module, library: bytes(library), lagc: bytes(lagc) };
}

export class Engine {
  constructor(told) {
    this.told = told; // of its state: starting, ready, busy, or a text that says what is wrong
    this.files = load();
    this.waiting = new Map(); // by kind
    this.start();
  }

  async start() {
    this.current = null;
    this.ready = false;
    this.told('starting');
    const worker = (this.worker = new Worker(URL.createObjectURL(new Blob([WORKER]))));
    worker.onmessage = ({ data }) => this.receive(data);
    worker.onerror = event => this.told(event.message || 'this browser cannot start Python');
    const files = await this.files;
    if (worker === this.worker) worker.postMessage({ files });
  }

  /** End what Python does; another worker takes its place. */
  stop() {
    this.worker.terminate();
    this.waiting.clear();
    this.current?.done({ stopped: true });
    this.start();
  }

  /** Resolve with the answer; with null if a later request of the kind took the place of this one. */
  ask(kind, asked) {
    return new Promise(done => {
      this.waiting.get(kind)?.done(null);
      this.waiting.set(kind, { kind, asked, done });
      this.next();
    });
  }

  next() {
    if (!this.ready || this.current) return;
    const [first] = this.waiting.values();
    if (!first) return;
    this.waiting.delete(first.kind);
    this.current = first;
    this.told('busy', first.kind);
    this.worker.postMessage({ id: 1, asked: { do: first.kind, ...first.asked } });
  }

  receive({ ready, found, broken }) {
    if (broken && !this.ready) return this.told(broken);
    if (ready) this.ready = true;
    const { current } = this;
    this.current = null;
    this.told('ready');
    current?.done(found ?? { broken });
    this.next();
  }
}
