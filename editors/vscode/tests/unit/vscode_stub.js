"use strict";

// The editor's programming interface as far as the extension and its client come to it. What is
// asked for and not given here is an empty class, which is enough for what is only extended or made.
const Module = require("node:module");
const fs = require("node:fs");
const path = require("node:path");

const BUNDLE = require.resolve("../../dist/extension.js");

class Emitter {
  constructor() {
    this.listeners = new Set();
    this.event = (listener, self) => {
      const bound = self ? listener.bind(self) : listener;
      this.listeners.add(bound);
      return { dispose: () => this.listeners.delete(bound) };
    };
  }
  fire(value) {
    for (const listener of [...this.listeners]) listener(value);
  }
  dispose() {
    this.listeners.clear();
  }
}

class Uri {
  constructor(scheme, fsPath) {
    Object.assign(this, { scheme, fsPath, path: fsPath, authority: "", query: "", fragment: "" });
  }
  static file(fsPath) {
    return new Uri("file", fsPath);
  }
  static parse(text) {
    return text.startsWith("file://") ? Uri.file(decodeURIComponent(text.slice(7))) : new Uri(...text.split(":"));
  }
  static joinPath(uri, ...parts) {
    return new Uri(uri.scheme, path.join(uri.fsPath, ...parts));
  }
  toString() {
    return this.scheme === "file" ? `file://${encodeURI(this.fsPath)}` : `${this.scheme}:${this.path}`;
  }
  with(change) {
    return Object.assign(new Uri(this.scheme, this.fsPath), change);
  }
}

class Position {
  constructor(line, character) {
    Object.assign(this, { line, character });
  }
}

class Range {
  constructor(start, end, endLine, endCharacter) {
    this.start = typeof start === "number" ? new Position(start, end) : start;
    this.end = typeof start === "number" ? new Position(endLine, endCharacter) : end;
  }
}

class Diagnostic {
  constructor(range, message, severity) {
    Object.assign(this, { range, message, severity });
  }
}

class Disposable {
  constructor(dispose) {
    this.dispose = dispose ?? (() => {});
  }
}

class CancellationTokenSource {
  constructor() {
    this.token = { isCancellationRequested: false, onCancellationRequested: () => new Disposable() };
  }
  cancel() {}
  dispose() {}
}

class CodeActionKind {
  constructor(value) {
    this.value = value;
  }
  append(part) {
    return new CodeActionKind(`${this.value}.${part}`);
  }
}
for (const kind of ["Empty", "QuickFix", "Refactor", "Source"]) CodeActionKind[kind] = new CodeActionKind(kind);

/** A document of the editor with this text. */
function document(file, text, languageId = "srg") {
  const uri = typeof file === "string" ? Uri.file(file) : file;
  const lines = text.split("\n");
  return {
    uri,
    languageId,
    fileName: uri.fsPath,
    version: 1,
    isClosed: false,
    isDirty: false,
    isUntitled: uri.scheme === "untitled",
    lineCount: lines.length,
    getText: () => text,
    save: async () => true,
  };
}

/**
 * A fresh editor: `vscode` is what the extension requires, the rest is what a test does and sees.
 *
 * @param {object} given settings, workspace folders, the answers to messages and questions, ...
 */
function editor(given = {}) {
  const seen = { messages: [], commands: new Map(), executed: [], output: [], tasks: [], panels: [], opened: [], diagnostics: new Map(), updates: [] };
  const events = {};
  const event = (name) => (events[name] ??= new Emitter()).event;
  const answer = (text, actions) => actions.find((action) => given.answers?.includes(action));
  const message = (level) => async (text, ...actions) => {
    seen.messages.push({ level, text, actions });
    return answer(text, actions);
  };
  const log = (text) => seen.output.push(String(text));
  const channel = { name: "SRG", append: log, appendLine: log, replace() {}, clear() {}, show: () => log("shown"), hide() {}, dispose() {}, logLevel: 3, onDidChangeLogLevel: event("logLevel"), trace: log, debug: log, info: log, warn: log, error: log };
  const folders = (given.folders ?? []).map((folder, index) => ({ uri: Uri.file(folder), name: path.basename(folder), index }));
  const documents = given.documents ?? [];
  const inside = (uri) => folders.find((folder) => uri.fsPath.startsWith(folder.uri.fsPath + path.sep) || uri.fsPath === folder.uri.fsPath);
  const vscode = {
    version: "1.100.0",
    CodeActionKind, Uri, Position, Range, Diagnostic, Disposable, CancellationTokenSource,
    EventEmitter: Emitter,
    DiagnosticSeverity: { Error: 0, Warning: 1, Information: 2, Hint: 3 },
    DiagnosticTag: { Unnecessary: 1, Deprecated: 2 },
    FileType: { File: 1, Directory: 2 },
    ProgressLocation: { Window: 10, Notification: 15 },
    TaskRevealKind: { Always: 1 },
    TaskScope: { Workspace: 2 },
    ConfigurationTarget: { Global: 1 },
    ViewColumn: { Beside: -2 },
    LogLevel: { Off: 0, Trace: 1, Debug: 2, Info: 3, Warning: 4, Error: 5 },
    ProcessExecution: class { constructor(process, args, options) { Object.assign(this, { process, args, options }); } },
    Task: class { constructor(definition, scope, name, source, execution) { Object.assign(this, { definition, scope, name, source, execution }); } },
    env: { appName: "stub", language: "en", remoteName: given.remote, openExternal: async (uri) => seen.opened.push(uri.fsPath), createTelemetryLogger: () => ({ logUsage() {}, logError() {}, dispose() {} }) },
    commands: {
      registerCommand(id, run) {
        if (seen.commands.has(id)) throw new Error(`command '${id}' already exists`);
        seen.commands.set(id, run);
        return new Disposable(() => seen.commands.delete(id));
      },
      async executeCommand(id, ...args) {
        seen.executed.push([id, ...args]);
        return seen.commands.get(id)?.(...args);
      },
    },
    window: {
      createOutputChannel: () => channel,
      showInformationMessage: message("information"),
      showWarningMessage: message("warning"),
      showErrorMessage: message("error"),
      showQuickPick: async (items) => given.pick?.(items),
      showOpenDialog: async () => given.dialog,
      withProgress: async (options, run) => run({ report() {} }, { isCancellationRequested: false, onCancellationRequested: () => new Disposable() }),
      createWebviewPanel(type, title) {
        const panel = { type, title, webview: { html: "" } };
        seen.panels.push(panel);
        return panel;
      },
      activeTextEditor: documents[0] && { document: documents[0] },
      visibleTextEditors: documents.map((shown) => ({ document: shown })),
      tabGroups: { all: [{ tabs: [] }], onDidChangeTabs: event("tabs"), onDidChangeTabGroups: event("tabGroups") },
      onDidChangeActiveTextEditor: event("activeEditor"),
      onDidChangeVisibleTextEditors: event("visibleEditors"),
      onDidChangeWindowState: event("windowState"),
      state: { focused: true },
    },
    workspace: {
      isTrusted: given.trusted ?? true,
      workspaceFolders: folders,
      textDocuments: documents,
      notebookDocuments: [],
      getWorkspaceFolder: inside,
      asRelativePath: (uri) => path.relative(inside(uri)?.uri.fsPath ?? "/", uri.fsPath ?? uri),
      getConfiguration: (section) => ({
        get: (key, otherwise) => given.settings?.[[section, key].filter(Boolean).join(".")] ?? otherwise,
        has: () => false,
        inspect: () => undefined,
        update: async (key, value) => seen.updates.push([key, value]),
      }),
      findFiles: async () => (given.found ?? []).map(Uri.file),
      openTextDocument: async (uri) => documents.find((open) => open.uri.fsPath === uri.fsPath),
      createFileSystemWatcher: () => ({ onDidCreate: event("created"), onDidChange: event("changed"), onDidDelete: event("deleted"), dispose() {} }),
      fs: {
        readFile: async (uri) => fs.promises.readFile(uri.fsPath),
        stat: async (uri) => ({ type: (await fs.promises.stat(uri.fsPath)).isDirectory() ? 2 : 1 }),
      },
    },
    tasks: {
      onDidEndTaskProcess: event("taskEnd"),
      async executeTask(task) {
        const execution = { task };
        seen.tasks.push(task);
        const exitCode = await given.run?.(task.execution);
        events.taskEnd.fire({ execution, exitCode });
        return execution;
      },
    },
    languages: {
      match: (selector, asked) => [selector].flat().some((filter) => filter.language === asked.languageId && (!filter.scheme || filter.scheme === asked.uri.scheme)) ? 10 : 0,
      createDiagnosticCollection: (name) => ({
        name,
        set: (uri, found) => { seen.diagnostics.set(uri.toString(), found ?? []); events.diagnostics?.fire(uri); },
        delete: (uri) => seen.diagnostics.delete(uri.toString()),
        clear: () => seen.diagnostics.clear(),
        has: () => false,
        get: (uri) => seen.diagnostics.get(uri.toString()),
        forEach() {},
        dispose() {},
      }),
    },
  };
  for (const [part, prefix] of [[vscode.workspace, "workspace"], [vscode.languages, "languages"], [vscode.window, "window"]]) wrap(part, prefix, event);
  for (const [, name] of fs.readFileSync(BUNDLE, "utf8").matchAll(/\.([A-Z]\w+)/g)) vscode[name] ??= class {};
  return { vscode, seen, events, on: (name, listener) => event(name)(listener) };
}

/** Events and registrations that nobody looks at. */
function wrap(part, prefix, event) {
  const known = { ...part };
  for (const name of Object.keys(known)) part[name] = known[name];
  Object.setPrototypeOf(part, new Proxy({}, {
    get(_, name) {
      if (/^on[A-Z]/.test(String(name))) return event(`${prefix}.${String(name)}`);
      if (/^(register|create)[A-Z]/.test(String(name))) return () => new Disposable();
      return undefined;
    },
  }));
}

/** The bundle, loaded anew, with this editor. */
function load(vscode) {
  delete require.cache[BUNDLE];
  const original = Module._load;
  Module._load = (request, ...rest) => (request === "vscode" ? vscode : original(request, ...rest));
  try {
    return require(BUNDLE);
  } finally {
    Module._load = original;
  }
}

module.exports = { document, editor, load, Uri };
