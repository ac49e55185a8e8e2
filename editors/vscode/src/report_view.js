"use strict";

const path = require("node:path");
const vscode = require("vscode");
const { show } = require("./messages");
const { reportPage } = require("./report_page");
const { resultFolder } = require("./result_folder");
const { runSrgc } = require("./run_srgc");
const { withProgress } = require("./verification");

/** Write the report of a result folder and show it, in the editor or in the browser. */
async function openReport(session, uri) {
  const folder = await resultFolder(uri);
  const program = folder && session.program(folder);
  if (!program) return;
  const page = vscode.Uri.joinPath(folder, "report.html");
  const ran = await withProgress("Writing the report", (signal) =>
    runSrgc(program, ["report", folder.fsPath, "-o", page.fsPath], session.folderOf(folder), signal),
  );
  if (!ran) return;
  if (ran.status !== 0) {
    session.output.error(`srgc report\n${ran.out}${ran.err}`);
    const reason = ran.err.trim().split("\n").at(-1) || "srgc report did not write a page";
    if (await show("error", reason, ["Show Details"])) session.output.show();
    return;
  }
  const settings = vscode.workspace.getConfiguration("srgc", folder);
  // In a window on another machine the page is there, and the browser is here.
  if (settings.get("report.openIn", "editor") === "browser" && !vscode.env.remoteName) {
    await vscode.env.openExternal(page);
    return;
  }
  const html = Buffer.from(await vscode.workspace.fs.readFile(page)).toString("utf8");
  const name = `${path.basename(folder.fsPath)}: report`;
  const panel = vscode.window.createWebviewPanel("srgc.report", name, vscode.ViewColumn.Beside, {
    enableScripts: true,
    enableFindWidget: true,
    localResourceRoots: [],
  });
  panel.webview.html = reportPage(html);
}

module.exports = { openReport };
