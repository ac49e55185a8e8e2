"use strict";

const vscode = require("vscode");
const { verificationOutcome } = require("./outcomes");
const { resultFolder } = require("./result_folder");
const { runSrgc } = require("./run_srgc");
const { show } = require("./messages");

/** Check a result folder with the independent checker, and say what it says. */
async function verifyFolder(session, uri) {
  const folder = await resultFolder(uri);
  const program = folder && session.program(folder);
  if (!program) return;
  const title = `Verifying ${vscode.workspace.asRelativePath(folder)}`;
  const ran = await withProgress(title, (signal) =>
    runSrgc(program, ["verify", folder.fsPath], session.folderOf(folder), signal),
  );
  if (!ran) return;
  session.output.info(`${title}\n${ran.out}${ran.err}`);
  const outcome = verificationOutcome(ran.status, ran.out);
  if (await show(outcome.level, outcome.text, ["Show Details"])) session.output.show();
}

/** Run something that takes long; undefined if the user has cancelled it. */
function withProgress(title, run) {
  const location = vscode.ProgressLocation.Notification;
  return vscode.window.withProgress({ location, title, cancellable: true }, async (_, token) => {
    const ending = new AbortController();
    token.onCancellationRequested(() => ending.abort());
    const ran = await run(ending.signal);
    return token.isCancellationRequested ? undefined : ran;
  });
}

module.exports = { verifyFolder, withProgress };
