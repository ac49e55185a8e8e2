"use strict";

const path = require("node:path");
const vscode = require("vscode");

/** What a result folder claims, of a task or of a mission. */
const CLAIMS = "**/{certificate,mission}.json";

/**
 * The result folder a command is about: that of the file it was called on, else one of the
 * workspace that the user picks.
 *
 * @param {vscode.Uri | undefined} uri a file of a result folder, or the folder itself
 * @returns {Promise<vscode.Uri | undefined>} undefined if there is none, or none was picked
 */
async function resultFolder(uri) {
  if (uri) {
    const stat = await vscode.workspace.fs.stat(uri);
    return stat.type & vscode.FileType.Directory ? uri : parent(uri);
  }
  const found = await vscode.workspace.findFiles(CLAIMS, "**/node_modules/**", 200);
  const folders = found.map(parent).sort((one, other) => (one.fsPath < other.fsPath ? -1 : 1));
  if (folders.length === 0) {
    void vscode.window.showInformationMessage(
      "There are no results in the workspace yet: synthesize a task first.",
    );
    return undefined;
  }
  const items = folders.map((folder) => ({
    label: path.basename(folder.fsPath),
    description: vscode.workspace.asRelativePath(folder),
    folder,
  }));
  const picked = await vscode.window.showQuickPick(items, { placeHolder: "A result folder" });
  return picked?.folder;
}

/** The folder a file is in. */
function parent(uri) {
  return vscode.Uri.file(path.dirname(uri.fsPath));
}

module.exports = { resultFolder };
