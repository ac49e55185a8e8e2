#!/usr/bin/env node
"use strict";

// Stands for `srgc` in tests: a language server that finds a fault in every file, and commands that
// say what they were asked.
const fs = require("node:fs");

const [command, folder, ...rest] = process.argv.slice(2);

function send(message) {
  const body = JSON.stringify({ jsonrpc: "2.0", ...message });
  process.stdout.write(`Content-Length: ${Buffer.byteLength(body)}\r\n\r\n${body}`);
}

function receive({ id, method, params }) {
  if (method === "initialize") {
    const commands = ["srgc.check", "srgc.synth", "srgc.verify"];
    send({ id, result: { capabilities: { textDocumentSync: 1, executeCommandProvider: { commands } } } });
  } else if (method === "textDocument/didOpen") {
    const { uri, text } = params.textDocument;
    const range = { start: { line: 0, character: 0 }, end: { line: 0, character: text.length } };
    send({
      method: "textDocument/publishDiagnostics",
      params: { uri, diagnostics: [{ range, severity: 1, code: "SRG0001", message: `read: ${text}` }] },
    });
  } else if (method === "workspace/executeCommand") {
    send({ id, result: [params.command, ...params.arguments] });
  } else if (method === "shutdown") {
    send({ id, result: null });
  } else if (method === "exit") {
    process.exit(0);
  }
}

function serve() {
  let waiting = Buffer.alloc(0);
  process.stdin.on("data", (chunk) => {
    waiting = Buffer.concat([waiting, chunk]);
    for (;;) {
      const end = waiting.indexOf("\r\n\r\n");
      if (end < 0) return;
      const length = Number(/Content-Length: (\d+)/.exec(waiting.subarray(0, end).toString())[1]);
      if (waiting.length < end + 4 + length) return;
      const body = waiting.subarray(end + 4, end + 4 + length).toString();
      waiting = waiting.subarray(end + 4 + length);
      receive(JSON.parse(body));
    }
  });
}

if (command === "lsp") {
  serve();
} else if (command === "verify") {
  process.stdout.write(`valid: found, level validated\n  of ${folder}\n`);
} else if (command === "report" && fs.existsSync(`${folder}/design.json`)) {
  fs.writeFileSync(rest[1], `<!doctype html><html><head lang="en"></head><body>${folder}</body></html>`);
} else {
  process.stderr.write(`error: ${folder} is not a result folder\n`);
  process.exitCode = 2;
}
