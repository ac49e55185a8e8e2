"use strict";

// The bundle that is shipped, in an editor that is a stub; srgc is a stand-in, and where the
// environment names one in SRGC, the real one.
const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const test = require("node:test");
const manifest = require("../../package.json");
const { document, editor, load, Uri } = require("./vscode_stub");

const FAKE = path.join(__dirname, "fake_srgc.js");

/** A workspace with a file and a result folder, removed after the test. */
function workspace(t) {
  const folder = fs.mkdtempSync(path.join(fs.realpathSync(os.tmpdir()), "srg-"));
  t.after(() => fs.rmSync(folder, { recursive: true, force: true }));
  const results = path.join(folder, "out", "Move");
  fs.mkdirSync(results, { recursive: true });
  fs.writeFileSync(path.join(results, "design.json"), "{}");
  return { folder, results, certificate: path.join(results, "certificate.json") };
}

/** The extension, active in an editor; it is put away after the test. */
async function activated(t, given) {
  const stub = editor(given);
  const context = { subscriptions: [] };
  t.after(async () => {
    for (const one of context.subscriptions.reverse()) await one.dispose();
  });
  await load(stub.vscode).activate(context);
  return { ...stub, run: (id, ...args) => stub.vscode.commands.executeCommand(id, ...args) };
}

/** Wait until something is so. */
async function until(condition, seconds = 20) {
  for (const end = Date.now() + seconds * 1000; Date.now() < end; ) {
    const value = condition();
    if (value) return value;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  return assert.fail(`not so after ${seconds} s: ${condition}`);
}

const using = (program) => ({ "srgc.path": program });

test("every command of the manifest is there, and no other", async (t) => {
  const { seen } = await activated(t, { trusted: false });
  const declared = manifest.contributes.commands.map(({ command }) => command);
  assert.deepEqual([...seen.commands.keys()].sort(), declared.sort());
});

test("nothing is run in a workspace that is not trusted, until it is", async (t) => {
  const { folder } = workspace(t);
  const given = { trusted: false, folders: [folder], settings: using(FAKE) };
  const { seen, run, vscode, events } = await activated(t, given);
  await run("srgc.restartServer");
  assert.deepEqual(seen.messages.map(({ level }) => level), ["information"]);
  assert.ok(!seen.commands.has("srgc.check"));
  vscode.workspace.isTrusted = true;
  events["workspace.onDidGrantWorkspaceTrust"].fire();
  await until(() => seen.commands.has("srgc.check"));
});

test("the server is started and its findings are shown; its commands do not collide", async (t) => {
  const { folder } = workspace(t);
  const file = document(path.join(folder, "arm.srg"), "module A");
  const given = { folders: [folder], settings: using(FAKE), documents: [file] };
  const { seen, run } = await activated(t, given);
  const [found] = await until(() => seen.diagnostics.get(file.uri.toString()));
  assert.equal(found.message, "read: module A");
  assert.ok(["srgc.check", "srgc.synth", "srgc.verify"].every((id) => seen.commands.has(id)));
  await run("srgc.restartServer");
  assert.ok(seen.commands.has("srgc.check"));
  assert.deepEqual(seen.messages, []);
});

test("what is open is saved before the server synthesizes, and only then", async (t) => {
  const { folder } = workspace(t);
  const saved = [];
  const open = (name, more) => ({
    ...document(path.join(folder, name), "task T { }"),
    isDirty: true,
    save: async () => saved.push(name),
    ...more,
  });
  const documents = [open("a.srg"), open("b.srg", { isDirty: false }), open("c.txt", { languageId: "text" })];
  const { run, seen } = await activated(t, { folders: [folder], settings: using(FAKE), documents });
  await until(() => seen.commands.has("srgc.synth"));
  await run("srgc.check", "file:///a.srg", "T");
  assert.deepEqual(saved, []);
  assert.deepEqual(await run("srgc.synth", "file:///a.srg", "T"), ["srgc.synth", "file:///a.srg", "T"]);
  assert.deepEqual(saved, ["a.srg"]);
});

test("where there is no srgc, that is said once, and where it can be mended", async (t) => {
  const { folder } = workspace(t);
  const given = { folders: [folder], settings: using("/gone/srgc"), answers: ["Open Settings"] };
  const { seen } = await activated(t, given);
  const [{ level, text, actions }, ...others] = seen.messages;
  assert.deepEqual([level, others], ["error", []]);
  assert.match(text, /\/gone\/srgc.*Install it/);
  assert.deepEqual(actions, ["Choose srgc", "Open Settings", "Try Again"]);
  await until(() => seen.executed.length);
  assert.deepEqual(seen.executed, [["workbench.action.openSettings", { query: "@id:srgc.path" }]]);
});

test("where VS Code runs on another machine, the setting is among those of that machine", async (t) => {
  const given = { settings: using("/gone"), answers: ["Open Settings"], remote: "ssh-remote" };
  const { seen } = await activated(t, given);
  await until(() => seen.executed.length);
  assert.deepEqual(seen.executed, [["workbench.action.openRemoteSettings", { query: "@id:srgc.path" }]]);
});

test("srgc may be chosen, which changes the setting and starts it", async (t) => {
  const given = { settings: using("/gone"), answers: ["Choose srgc"], dialog: [Uri.file(FAKE)] };
  const { seen, events } = await activated(t, given);
  await until(() => seen.updates.length);
  assert.deepEqual(seen.updates, [["path", FAKE]]);
  given.settings["srgc.path"] = FAKE;
  events["workspace.onDidChangeConfiguration"].fire({ affectsConfiguration: (key) => key === "srgc.path" });
  await until(() => seen.commands.has("srgc.check"));
});

test("a program that is no language server is named", async (t) => {
  const { seen } = await activated(t, { settings: using("/bin/false") });
  await until(() => seen.messages.some(({ text }) => /\/bin\/false did not start/.test(text)));
});

test("a result folder is verified", async (t) => {
  const { folder, results, certificate } = workspace(t);
  const given = { folders: [folder], settings: using(FAKE), found: [certificate], pick: ([only]) => only };
  const { seen, run } = await activated(t, given);
  await run("srgc.verifyFolder");
  assert.equal(seen.messages[0].text, "valid: found, level validated");
  assert.ok(seen.output.some((text) => text.includes(`of ${results}`)));
});

test("without results there is nothing to verify", async (t) => {
  const { seen, run } = await activated(t, { settings: using(FAKE) });
  await run("srgc.verifyFolder");
  assert.match(seen.messages[0].text, /no results/);
});

test("a report is written and shown, and may load nothing", async (t) => {
  const { folder, results } = workspace(t);
  const { seen, run } = await activated(t, { folders: [folder], settings: using(FAKE) });
  await run("srgc.openReport", Uri.file(path.join(results, "design.json")));
  const [{ title, webview }] = seen.panels;
  assert.equal(title, "Move: report");
  assert.ok(webview.html.includes(`<body>${results}</body>`));
  assert.match(webview.html, /default-src 'none'/);
});

test("a report on another machine is shown in the editor, as no browser here can read it", async (t) => {
  const { folder, results } = workspace(t);
  const settings = { ...using(FAKE), "srgc.report.openIn": "browser" };
  const { seen, run } = await activated(t, { folders: [folder], settings, remote: "ssh-remote" });
  await run("srgc.openReport", Uri.file(path.join(results, "design.json")));
  assert.deepEqual([seen.opened.length, seen.panels.length], [0, 1]);
});

test("a report in the browser", async (t) => {
  const { folder, results } = workspace(t);
  const settings = { ...using(FAKE), "srgc.report.openIn": "browser" };
  const { seen, run } = await activated(t, { folders: [folder], settings });
  await run("srgc.openReport", Uri.file(results));
  assert.deepEqual(seen.opened, [path.join(results, "report.html")]);
  assert.deepEqual(seen.panels, []);
});

test("why there is no report is said", async (t) => {
  const { folder } = workspace(t);
  const { seen, run } = await activated(t, { folders: [folder], settings: using(FAKE) });
  await run("srgc.openReport", Uri.file(folder));
  assert.deepEqual(seen.messages.map(({ text }) => text), [`error: ${folder} is not a result folder`]);
  assert.deepEqual(seen.panels, []);
});

test("a task is synthesized in a terminal, with its results where srgc puts them", async (t) => {
  const { folder } = workspace(t);
  const file = document(path.join(folder, "arm.srg"), "task Move { } task Turn { }");
  const given = { folders: [folder], settings: using(FAKE), documents: [file], run: () => 0 };
  const { seen, run } = await activated(t, { ...given, pick: (names) => names[1] });
  await run("srgc.synthesizeTask");
  const [{ process, args, options }] = seen.tasks.map((task) => task.execution);
  assert.deepEqual([process, options.cwd], [FAKE, folder]);
  assert.deepEqual(args, ["synth", file.uri.fsPath, "--task", "Turn", "-o", path.join("out", "Turn")]);
  assert.deepEqual(seen.messages.at(-1).actions, ["Open Report", "Verify"]);
});

test("older results are replaced only after a question", async (t) => {
  const { folder } = workspace(t);
  const file = document(path.join(folder, "arm.srg"), "task Move { }");
  const run = ({ args }) => (args.includes("--force") ? 0 : 2);
  const given = { folders: [folder], settings: using(FAKE), documents: [file], run };
  const asked = await activated(t, given);
  await asked.run("srgc.synthesizeTask");
  assert.equal(asked.seen.tasks.length, 1);
  const agreed = await activated(t, { ...given, answers: ["Replace Results"] });
  await agreed.run("srgc.synthesizeTask", file.uri);
  assert.equal(agreed.seen.tasks.length, 2);
  assert.ok(agreed.seen.tasks[1].execution.args.includes("--force"));
});

test("a file that is no .srg, and one without a task", async (t) => {
  const { seen, run } = await activated(t, { settings: using(FAKE) });
  await run("srgc.synthesizeTask");
  assert.match(seen.messages[0].text, /Open an \.srg file/);
  const file = document("/nowhere/arm.srg", "edge eps;");
  const other = await activated(t, { settings: using(FAKE), documents: [file] });
  await other.run("srgc.synthesizeTask");
  assert.match(other.seen.messages[0].text, /no task/);
});

test("the real srgc", { skip: !process.env.SRGC && "the variable SRGC names none" }, async (t) => {
  const { folder } = workspace(t);
  const text = "module Link { role link; const length = 3 kg; param size in [2, 1] m; }\n";
  const file = document(path.join(folder, "link.srg"), text);
  fs.writeFileSync(file.uri.fsPath, text);
  const given = { folders: [folder], settings: using(process.env.SRGC), documents: [file] };
  const { seen } = await activated(t, given);
  const found = await until(() => seen.diagnostics.get(file.uri.toString())?.length && seen.diagnostics.get(file.uri.toString()), 60);
  assert.ok(found.every(({ code }) => /^SRG\d{4}$/.test(code?.value ?? code)), JSON.stringify(found));
  assert.ok(found.some(({ range }) => range.start.line === 0 && text.slice(range.start.character, range.end.character).includes("[2, 1]")), JSON.stringify(found));
  assert.ok(["srgc.check", "srgc.synth", "srgc.verify"].every((id) => seen.commands.has(id)));
});
