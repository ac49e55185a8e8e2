// The worker: Python with srgc in it, which answers one request after the other.
//
// It is started by a worker without a file of its own (engine.js), so that the policy of the page
// holds here too: nothing can be fetched but from where the page comes from.

import { unzipSync } from "fflate";

const PLACE = new URL("./", import.meta.url);
const SITE = "/srgc";
const EARLY = new Set(["check", "explain"]); // the first archive has most of what they need
let python;
let answer;
let complete;

const at = (path) => new URL(path, PLACE).href;

async function bytes(path) {
  const response = await fetch(at(path));
  if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
}

// The files of an archive; to unpack them in Python takes longer.
const unzipped = async (name) => unzipSync(new Uint8Array(await bytes(`packages/${name}`)));

function place(files) {
  const folders = new Set();
  for (const [name, data] of Object.entries(files)) {
    if (name.endsWith("/")) continue;
    const path = `${SITE}/${name}`;
    const folder = path.slice(0, path.lastIndexOf("/"));
    if (!folders.has(folder)) python.FS.mkdirTree(folder);
    folders.add(folder);
    python.FS.writeFile(path, data, { canOwn: true });
  }
}

async function start() {
  const files = unzipped(ARCHIVES.first);
  const { loadPyodide } = await import(at("pyodide/pyodide.mjs"));
  python = await loadPyodide({
    indexURL: at("pyodide/"),
    stdLibURL: at(`packages/${ARCHIVES.library}`),
  });
  place(await files);
  python.runPython(`
import gc, sys
gc.set_threshold(50_000, 20, 20)
sys.path.insert(0, "${SITE}")
from srgc.playground.answers import answer
`);
  answer = python.globals.get("answer");
}

// The other modules, and what completion, hovers, formatting and drawing need besides; fetched when
// the first findings are shown.
async function rest() {
  (await Promise.all(ARCHIVES.rest.map(unzipped))).forEach(place);
  python.runPython(`
import importlib
importlib.invalidate_caches()
import srgc.formatting.canonical_form
import srgc.language_server.completions.completion
import srgc.language_server.hovers.hover
`);
}

async function drawn(dot) {
  const { instance } = await import("@viz-js/viz");
  return (await instance()).renderString(dot, { format: "svg" });
}

const FETCH = {
  srgc: () => (complete ??= rest()),
  flint: () => {
    postMessage({ fetching: "flint" });
    return python.loadPackage(at(`packages/${ARCHIVES.flint}`), { messageCallback: () => {} });
  },
};

async function answered(request) {
  if (!EARLY.has(request.ask)) await FETCH.srgc();
  const asked = () => JSON.parse(answer(JSON.stringify(request)));
  let found = asked();
  const fetched = new Set();
  while (found.needs && !fetched.has(found.needs)) {
    fetched.add(found.needs);
    await FETCH[found.needs]();
    found = asked();
  }
  if (found.needs) throw new Error(`${found.needs} cannot be loaded`);
  if (found.answer?.dot) found.answer.svg = await drawn(found.answer.dot);
  return found;
}

const started = start();
started.then(
  () => postMessage({ started: true }),
  (error) => postMessage({ failed: String(error) }),
);

addEventListener("message", async ({ data: { id, request } }) => {
  try {
    await started;
    postMessage({ id, found: await answered(request) });
    complete ??= rest();
  } catch (error) {
    postMessage({ id, found: { fault: String(error) } });
  }
});
