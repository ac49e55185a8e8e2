"use strict";

const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { findSrgc } = require("./find_srgc");
const { Server } = require("./server");
const { openReport } = require("./report_view");
const { synthesizeTask } = require("./synthesis");
const { verifyFolder } = require("./verification");

/** What is shared by all commands while the extension is active. */
class Session {
  constructor() {
    this.output = vscode.window.createOutputChannel("SRG", { log: true });
    this.server = new Server(this);
  }

  /** The folder that belongs to a file: that of its workspace, else its own. */
  folderOf(uri) {
    const folder = vscode.workspace.getWorkspaceFolder(uri);
    return folder ? folder.uri.fsPath : path.dirname(uri.fsPath);
  }

  /** The paths of all workspace folders, that of the file before the others. */
  folders(uri) {
    const all = (vscode.workspace.workspaceFolders ?? [])
      .filter((folder) => folder.uri.scheme === "file")
      .map((folder) => folder.uri.fsPath);
    const own = uri && this.folderOf(uri);
    return all.includes(own) ? [own, ...all.filter((folder) => folder !== own)] : all;
  }

  /** The `srgc` to run, or undefined after the user has been told that there is none. */
  program(uri) {
    if (!vscode.workspace.isTrusted) {
      void vscode.window.showInformationMessage("srgc is not started until you trust the workspace.");
      return undefined;
    }
    const found = findSrgc({
      setting: vscode.workspace.getConfiguration("srgc", uri).get("path", ""),
      folders: this.folders(uri),
      env: process.env,
      home: os.homedir(),
      platform: process.platform,
    });
    if ("path" in found) return found.path;
    this.output.warn(found.missing);
    void this.offerHelp(found.missing);
    return undefined;
  }

  /** Say that there is no `srgc`, and go where that can be mended. */
  async offerHelp(missing) {
    const advice = `${missing} Install it, for instance with \`pip install srgc\`, or say where it is.`;
    const choice = await vscode.window.showErrorMessage(advice, "Choose srgc", "Open Settings", "Try Again");
    if (choice === "Open Settings") {
      // In a window on another machine the setting is that machine's, not the user's.
      const where = vscode.env.remoteName ? "openRemoteSettings" : "openSettings";
      await vscode.commands.executeCommand(`workbench.action.${where}`, { query: "@id:srgc.path" });
    } else if (choice === "Try Again") {
      await this.server.restart();
    } else if (choice === "Choose srgc") {
      const [file] = (await vscode.window.showOpenDialog({ title: "The program srgc" })) ?? [];
      if (file) {
        const settings = vscode.workspace.getConfiguration("srgc");
        await settings.update("path", file.fsPath, vscode.ConfigurationTarget.Global);
      }
    }
  }
}

/** @param {vscode.ExtensionContext} context */
async function activate(context) {
  const session = new Session();
  const commands = {
    "srgc.synthesizeTask": (uri) => synthesizeTask(session, uri),
    "srgc.verifyFolder": (uri) => verifyFolder(session, uri),
    "srgc.openReport": (uri) => openReport(session, uri),
    "srgc.restartServer": () => session.server.restart(),
    "srgc.showOutput": () => session.output.show(),
  };
  context.subscriptions.push(
    session.output,
    session.server,
    ...Object.entries(commands).map(([id, run]) => vscode.commands.registerCommand(id, run)),
    vscode.workspace.onDidGrantWorkspaceTrust(() => session.server.restart()),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("srgc.path")) void session.server.restart();
    }),
  );
  if (vscode.workspace.isTrusted) await session.server.start();
}

module.exports = { activate };
