"use strict";

const os = require("node:os");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

/** Save what is open before a synthesis: it takes what is on the disk, of included files too. */
async function saveFirst(command, args, next) {
  const changed = vscode.workspace.textDocuments.filter(
    (document) => document.languageId === "srg" && document.isDirty && !document.isUntitled,
  );
  if (command === "srgc.synth") await Promise.all(changed.map((document) => document.save()));
  return next(command, args);
}

/** The language server `srgc lsp` of this window; not more than one runs at a time. */
class Server {
  constructor(session) {
    this.session = session;
    this.client = undefined;
    this.turn = Promise.resolve();
  }

  start() {
    return this.inTurn(() => this.begin());
  }

  restart() {
    return this.inTurn(async () => {
      await this.end();
      await this.begin();
    });
  }

  dispose() {
    return this.inTurn(() => this.end());
  }

  /** One after the other, so that two restarts do not leave two servers. */
  inTurn(action) {
    this.turn = this.turn.then(action, action);
    return this.turn;
  }

  async begin() {
    const uri = vscode.window.activeTextEditor?.document.uri;
    const command = this.session.program(uri?.scheme === "file" ? uri : undefined);
    if (!command) return;
    const cwd = this.session.folders()[0] ?? os.homedir();
    this.session.output.info(`${command} lsp, in ${cwd}`);
    const client = new LanguageClient(
      "srgc",
      "SRG",
      { command, args: ["lsp"], options: { cwd } },
      {
        documentSelector: [
          { scheme: "file", language: "srg" },
          { scheme: "untitled", language: "srg" },
        ],
        outputChannel: this.session.output,
        traceOutputChannel: this.session.output,
        middleware: { executeCommand: saveFirst },
      },
    );
    try {
      await client.start();
      this.client = client;
    } catch (error) {
      this.session.output.error(String(error));
      void this.tell(command);
    }
  }

  async tell(command) {
    const choice = await vscode.window.showErrorMessage(
      `${command} did not start as a language server. Is it an srgc that has \`srgc lsp\`?`,
      "Show Output",
    );
    if (choice) this.session.output.show();
  }

  async end() {
    const client = this.client;
    this.client = undefined;
    try {
      await client?.dispose();
    } catch (error) {
      this.session.output.warn(String(error));
    }
  }
}

module.exports = { Server };
