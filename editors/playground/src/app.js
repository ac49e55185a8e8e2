// The page: the spec on one side, what srgc says of it on the other.

import { Editor } from "./editor.js";
import { Engine } from "./engine.js";
import { fragment, shared } from "./share.js";
import { Tabs } from "./tabs.js";
import { terminal } from "./terminal.js";

const PAUSE = 40; // ms without a change before a text is looked at
const PATIENCE = 1000; // ms before one may stop what runs
const LIBRARIES = { flint: "python-flint (7 MB), which this spec needs" };

const $ = (id) => document.getElementById(id);
const texts = {}; // of the examples
let changedAt = performance.now();
let said = "";
let patience;
let pause;

// --- What is going on ------------------------------------------------------------------------------

function status(text, name = "") {
  if ($("status").textContent !== text) $("status").textContent = text;
  $("status").className = name;
}

function told({ state, detail }) {
  document.body.dataset.state = state;
  clearTimeout(patience);
  $("stop").hidden = true;
  if (state === "loading") status(`Loading ${LIBRARIES[detail] ?? "Python and srgc"} …`);
  if (state === "ready") status(said || "Ready.");
  if (state === "failed") status(`The playground cannot run: ${detail}`, "failed");
  if (state === "busy" || detail) {
    patience = setTimeout(() => {
      $("stop").hidden = false;
      status("Still at it; Stop ends it.");
    }, PATIENCE);
  }
}

function counted(findings) {
  const counts = ["error", "warning", "note"].map((kind) => {
    const number = findings.filter((each) => each.severity === kind).length;
    return number && `${number} ${kind}${number > 1 ? "s" : ""}`;
  });
  return counts.filter(Boolean).join(", ") || "No errors";
}

// --- What the tabs show ----------------------------------------------------------------------------

const links = {
  explain: (code) => {
    $("code").value = code;
    tabs.choose("explain");
    $("tab-explain").focus();
  },
  show: (line, column) => editor.show(line, column),
};

const shownIn = (element, text) => element.replaceChildren(terminal(text, links));

function items(list, texts) {
  list.replaceChildren(
    ...texts.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }),
  );
}

function grammars(names) {
  const before = $("grammar").value;
  $("which").hidden = names.length < 2;
  $("grammar").replaceChildren(...names.map((name) => new Option(name, name)));
  $("grammar").value = names.includes(before) ? before : (names[0] ?? "");
}

const SHOW = {
  async check(text) {
    const found = await engine.ask({ ask: "check", text });
    if (!found || text !== editor.text) return;
    const { shown, findings, places, unchecked, grammars: names } =
      found.answer ?? { shown: found.fault, findings: [], places: [], unchecked: [], grammars: [] };
    shownIn($("findings"), shown);
    items($("unchecked"), unchecked);
    editor.mark(findings, places);
    if (names.length) grammars(names);
    said = found.fault ? "Not checked: see Findings." : `${counted(findings)}.`;
    status(said);
    performance.measure("srgc answer", { start: changedAt, end: performance.now() });
  },

  async fmt(text) {
    const found = await engine.ask({ ask: "fmt", text });
    if (!found || text !== editor.text) return;
    const { text: made, changes } = found.answer ?? {};
    if (found.fault) shownIn($("formatted"), found.fault);
    else $("formatted").textContent = made;
    $("apply").disabled = !changes;
    $("canonical").textContent = found.fault ? "A text with errors in its syntax has no other form." : changes ? "" : "The spec is in canonical form.";
  },

  async graph(text) {
    const of = $("of").value;
    $("deep").hidden = of !== "words";
    const depth = of === "words" ? Number($("depth").value) || 0 : 0;
    const grammar = $("which").hidden ? "" : $("grammar").value;
    const chosen = { of, grammar, word: $("word").value, depth };
    const found = await engine.ask({ ask: "graph", text, ...chosen });
    if (!found || text !== editor.text) return;
    $("drawn").hidden = Boolean(found.fault);
    $("drawn-fault").hidden = !found.fault;
    if (found.fault) return shownIn($("drawn-fault"), found.fault);
    const { dot, notes, svg } = found.answer;
    URL.revokeObjectURL($("picture").src);
    $("picture").src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    $("picture").alt = `${$("of").selectedOptions[0].text} ${chosen.grammar}; its text is below, under DOT`;
    $("save").href = $("picture").src;
    $("dot").textContent = dot;
    items($("notes"), notes);
  },

  async explain() {
    const found = await engine.ask({ ask: "explain", text: "", code: $("code").value });
    if (found) shownIn($("explained"), found.answer?.shown ?? found.fault);
  },
};

async function look() {
  const { text } = editor;
  await SHOW.check(text); // which says what grammars there are
  if (text !== editor.text) return;
  if (tabs.chosen === "fmt" || tabs.chosen === "graph") SHOW[tabs.chosen](text);
}

function changed() {
  changedAt = performance.now();
  if (texts[$("example").value] !== editor.text) $("example").value = "";
  clearTimeout(pause);
  pause = setTimeout(look, PAUSE);
}

async function format() {
  const { text } = editor;
  const found = await engine.ask({ ask: "fmt", text });
  if (!found || text !== editor.text) return;
  if (found.fault) return tabs.choose("check");
  if (found.answer.changes) editor.text = found.answer.text;
  status(found.answer.changes ? "Formatted." : "The spec is in canonical form.");
}

// --- Examples and links ----------------------------------------------------------------------------

async function examples() {
  const groups = await (await fetch("examples.json")).json();
  $("example").append(new Option("Choose …", ""));
  for (const { group, specs } of groups) {
    const made = document.createElement("optgroup");
    made.label = group;
    for (const { name, text } of specs) {
      texts[`${group}/${name}`] = text;
      made.append(new Option(name, `${group}/${name}`));
    }
    $("example").append(made);
  }
  $("example").addEventListener("change", () => {
    const text = texts[$("example").value];
    if (text !== undefined) editor.text = text;
  });
  return groups[0].specs[0].text;
}

async function linked() {
  try {
    return await shared(location.hash);
  } catch (error) {
    status(`The link has no spec that can be read: ${error.message}`, "failed");
    return null;
  }
}

async function share() {
  history.replaceState(null, "", await fragment(editor.text));
  try {
    await navigator.clipboard.writeText(location.href);
    status("The link is copied.");
  } catch {
    status("The address of this page is now the link.");
  }
}

// --- The start -------------------------------------------------------------------------------------

const engine = new Engine(told);
const editor = new Editor($("editor"), {
  ask: (request) => engine.ask(request),
  changed,
  explain: links.explain,
  format,
});
const tabs = new Tabs(document.querySelector("[role=tablist]"), (id) => {
  if (engine.ready || id === "explain") SHOW[id](editor.text);
});

$("format").addEventListener("click", format);
$("apply").addEventListener("click", format);
$("share").addEventListener("click", share);
$("stop").addEventListener("click", () => {
  said = "Stopped; the next change is looked at again.";
  engine.stop();
  editor.view.focus();
});
$("drawing").addEventListener("input", () => SHOW.graph(editor.text));
$("drawing").addEventListener("submit", (event) => event.preventDefault());
$("size").addEventListener("change", () => {
  document.querySelector(".picture").classList.toggle("actual", $("size").checked);
});
$("asking").addEventListener("submit", (event) => {
  event.preventDefault();
  SHOW.explain();
});
addEventListener("hashchange", async () => {
  const text = await linked();
  if (text !== null) editor.text = text;
});

const first = examples();
editor.text = (await linked()) ?? (await first);

// For scripts and tests: the text, and every request that the page makes.
window.playground = {
  get text() { return editor.text; },
  set text(text) { editor.text = text; },
  ask: (request) => engine.ask(request),
};
