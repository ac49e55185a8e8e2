// Requests to the worker: of each kind the newest counts, and a worker that hangs is replaced.

const FIRST = ["complete", "hover", "check"]; // before what a tab shows

export class Engine {
  // `tell` is told of { state: "loading" | "ready" | "busy" | "failed", detail }.
  constructor(tell) {
    this.tell = tell;
    this.waiting = new Map();
    this.count = 0;
    this.start();
  }

  start() {
    this.ready = false;
    this.running = null;
    const file = JSON.stringify(new URL("worker.js", import.meta.url).href);
    const blob = URL.createObjectURL(new Blob([`import ${file};`], { type: "text/javascript" }));
    const worker = new Worker(blob, { type: "module" });
    this.worker = worker;
    worker.onmessage = ({ data }) => {
      if (worker === this.worker) this.hear(data);
    };
    worker.onerror = (event) => {
      if (worker === this.worker) this.fail(event.message || "the worker cannot be started");
    };
    this.tell({ state: "loading" });
    this.next();
  }

  // What `request` is answered; null if a newer one of its kind came first, or it was stopped.
  ask(request) {
    return new Promise((resolve) => {
      this.waiting.get(request.ask)?.resolve(null);
      this.waiting.set(request.ask, { request, resolve });
      this.next();
    });
  }

  // End what runs now; the next request is answered by another worker.
  stop() {
    this.worker.terminate();
    for (const each of [this.running, ...this.waiting.values()]) each?.resolve(null);
    this.waiting.clear();
    this.start();
  }

  next() {
    if (this.running || this.failed) return;
    const kinds = [...FIRST, ...this.waiting.keys()];
    const kind = kinds.find((each) => this.waiting.has(each));
    if (!kind) return;
    this.running = { ...this.waiting.get(kind), id: ++this.count };
    this.waiting.delete(kind);
    this.worker.postMessage({ id: this.running.id, request: this.running.request });
    if (this.ready) this.tell({ state: "busy" });
  }

  hear({ started, failed, fetching, id, found }) {
    if (failed) this.fail(failed);
    else if (fetching) this.tell({ state: "loading", detail: fetching });
    else if (started) {
      this.ready = true;
      this.tell({ state: this.running ? "busy" : "ready" });
    } else if (this.running?.id === id) {
      const { resolve } = this.running;
      this.running = null;
      this.tell({ state: "ready" });
      resolve(found);
      this.next();
    }
  }

  fail(detail) {
    this.failed = true;
    for (const each of [this.running, ...this.waiting.values()]) each?.resolve(null);
    this.tell({ state: "failed", detail });
  }
}
