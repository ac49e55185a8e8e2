"use strict";

const path = require("node:path");
const vscode = require("vscode");
const { show } = require("./messages");
const { synthesisOutcome } = require("./outcomes");
const { openReport } = require("./report_view");
const { taskNames } = require("./task_names");
const { verifyFolder } = require("./verification");

/** Synthesize a task of a file in a terminal, where it can be watched and interrupted. */
async function synthesizeTask(session, uri) {
  const document = await documentOf(uri);
  if (!document) return;
  const program = session.program(document.uri);
  if (!program || !(await document.save())) return;
  const task = await chosenTask(document);
  if (!task) return;
  // Beside the file, where the lenses of the language server look for results.
  const cwd = path.dirname(document.uri.fsPath);
  await run(session, { program, file: document.uri, cwd, task });
}

/** The .srg file a command is about, or undefined after the user has been told. */
async function documentOf(uri) {
  const document = uri
    ? await vscode.workspace.openTextDocument(uri)
    : vscode.window.activeTextEditor?.document;
  if (document?.languageId === "srg" && document.uri.scheme === "file") return document;
  void vscode.window.showInformationMessage("Open an .srg file on the disk first.");
  return undefined;
}

async function chosenTask(document) {
  const names = taskNames(document.getText());
  if (names.length === 0) {
    void vscode.window.showInformationMessage("This file has no task.");
    return undefined;
  }
  return names.length === 1
    ? names[0]
    : vscode.window.showQuickPick(names, { placeHolder: "The task to synthesize" });
}

async function run(session, { program, file, cwd, task }, force = false) {
  const folder = vscode.Uri.file(path.join(cwd, "out", task));
  const args = ["synth", file.fsPath, "--task", task, "-o", path.join("out", task)];
  const status = await inTerminal(`synth ${task}`, program, force ? [...args, "--force"] : args, cwd);
  const outcome = synthesisOutcome(status, task);
  const actions = {
    "Open Report": () => openReport(session, folder),
    Verify: () => verifyFolder(session, folder),
    Why: () => inTerminal(`why ${task}`, program, ["why", folder.fsPath], cwd),
    "Show Problems": () => vscode.commands.executeCommand("workbench.actions.view.problems"),
    "Replace Results": () => run(session, { program, file, cwd, task }, true),
  };
  const choice = await show(outcome.level, outcome.text, outcome.actions);
  if (choice) await actions[choice]();
}

/** Run a program as a task of the editor; its exit status, undefined if it was ended. */
async function inTerminal(name, program, args, cwd) {
  const definition = { type: "srgc", args };
  const execution = new vscode.ProcessExecution(program, args, { cwd });
  const task = new vscode.Task(definition, vscode.TaskScope.Workspace, name, "srgc", execution, []);
  task.presentationOptions = { reveal: vscode.TaskRevealKind.Always, clear: true };
  // Whoever listens only after the start may miss the end of a short run.
  const ends = [];
  let told = () => {};
  const listening = vscode.tasks.onDidEndTaskProcess((event) => {
    ends.push(event);
    told();
  });
  try {
    const started = await vscode.tasks.executeTask(task);
    for (;;) {
      const own = ends.find((event) => event.execution === started);
      if (own) return own.exitCode;
      await new Promise((resolve) => (told = resolve));
    }
  } finally {
    listening.dispose();
  }
}

module.exports = { synthesizeTask };
