"use strict";

// Bundles the extension into one file, with the licences of the packages that are in it beside it.
const fs = require("node:fs");
const path = require("node:path");
const esbuild = require("esbuild");

const bundled = esbuild.buildSync({
  entryPoints: ["src/extension.js"],
  absWorkingDir: __dirname,
  outfile: "dist/extension.js",
  bundle: true,
  minify: true,
  platform: "node",
  target: "node20",
  format: "cjs",
  external: ["vscode"],
  metafile: true,
});

const folders = new Set();
for (const file of Object.keys(bundled.metafile.inputs)) {
  const [folder] = /^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file) ?? [];
  if (folder) folders.add(folder);
}
const notices = [...folders].sort().map((folder) => {
  const place = path.join(__dirname, folder);
  const { name, version, license } = JSON.parse(fs.readFileSync(path.join(place, "package.json")));
  const file = fs.readdirSync(place).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`${name} has no licence file`);
  const text = fs.readFileSync(path.join(place, file), "utf8").trim();
  return `${name} ${version} (${license})\n\n${text}\n`;
});
fs.writeFileSync(
  path.join(__dirname, "dist", "THIRD_PARTY_NOTICES.txt"),
  notices.join(`\n${"-".repeat(80)}\n\n`),
);
