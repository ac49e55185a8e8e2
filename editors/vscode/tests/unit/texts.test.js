"use strict";

const assert = require("node:assert/strict");
const test = require("node:test");
const { synthesisOutcome, verificationOutcome } = require("../../src/outcomes");
const { PLAIN, POLICY, reportPage } = require("../../src/report_page");
const { runSrgc } = require("../../src/run_srgc");
const { taskNames } = require("../../src/task_names");

test("tasks are found outside of braces, comments and strings", () => {
  const text = `
    // task A { }
    /* task B { } */ edge 'task C {', "}";
    task First /* here */
    { robot task; }
    module task { const task = 1; }
    workspace W { obstacle task polytope { x <= 1 } ; }
    semantics S { task { } }
    task Second{ satisfy task; }`;
  assert.deepEqual(taskNames(text), ["First", "Second"]);
});

test("texts that are not finished", () => {
  assert.deepEqual(taskNames(""), []);
  assert.deepEqual(taskNames("task"), []);
  assert.deepEqual(taskNames("task {"), []);
  assert.deepEqual(taskNames("} task A {"), ["A"]);
  assert.deepEqual(taskNames("task A { } /* task B {"), ["A"]);
  assert.deepEqual(taskNames("edge 'open;\ntask A {"), ["A"]);
});

test("every exit status of a synthesis has its words, and actions that go with it", () => {
  for (const status of [0, 1, 2, 3, 4, 5, 70, 130, undefined]) {
    assert.match(synthesisOutcome(status, "T").text, /^T: .*\.$/);
  }
  assert.deepEqual(synthesisOutcome(0, "T").actions, ["Open Report", "Verify"]);
  assert.ok(synthesisOutcome(4, "T").actions.includes("Why"));
  assert.ok(!synthesisOutcome(4, "T").actions.includes("Verify"));
  assert.deepEqual(synthesisOutcome(70, "T").actions, []);
  assert.equal(synthesisOutcome(70, "T").level, "error");
});

test("only a valid result is called one", () => {
  assert.deepEqual(verificationOutcome(0, "valid: found\nmore"), { level: "information", text: "valid: found" });
  assert.equal(verificationOutcome(1, "refuted: start\n").level, "error");
  assert.equal(verificationOutcome(4, "undecided\n").level, "warning");
  assert.equal(verificationOutcome(null, "").level, "error");
});

test("a report may load nothing", () => {
  const meta = `<meta http-equiv="Content-Security-Policy" content="${POLICY}">`;
  const own = `${meta}<style>${PLAIN}</style>`;
  assert.equal(reportPage("<html><HEAD a='b'><title>"), `<html><HEAD a='b'>${own}<title>`);
  assert.equal(reportPage("<p>"), `${own}<p>`);
  assert.match(POLICY, /^default-src 'none'/);
  assert.doesNotMatch(POLICY, /https?:|\*/);
});

test("a report keeps its own colours, whatever the theme of the editor", () => {
  // VS Code puts its own style before ours: `code` and links get the colours of the theme.
  for (const [selector, property] of [["code", "background"], ["code", "color"], ["a:hover", "color"]]) {
    const rules = [...PLAIN.matchAll(/([^{}]+)\{([^{}]*)\}/g)].filter(([, selectors]) =>
      selectors.split(",").some((one) => one.trim() === selector),
    );
    assert.ok(rules.some(([, , body]) => new RegExp(`(^|[; ])${property}: (inherit|none);`).test(body)), selector);
  }
  assert.doesNotMatch(PLAIN, /vscode/);
});

test("a program is run without a shell, and its status is known", async () => {
  const run = (code, ...args) => runSrgc(process.execPath, ["-e", code, ...args], __dirname);
  const print = "console.log(process.argv[1]); process.exit(3)";
  assert.deepEqual(await run(print, "$HOME; `id`"), { status: 3, out: "$HOME; `id`\n", err: "" });
  assert.equal((await run("")).status, 0);
  const gone = await runSrgc("/gone/srgc", [], __dirname);
  assert.equal(gone.status, null);
  assert.match(gone.err, /ENOENT/);
});

test("a run can be ended", async () => {
  const ending = new AbortController();
  const ran = runSrgc(process.execPath, ["-e", "setInterval(() => {}, 1000)"], __dirname, ending.signal);
  ending.abort();
  assert.equal((await ran).status, null);
});
