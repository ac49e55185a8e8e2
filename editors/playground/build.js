// Assembles the page: node build.js WHEELS TARGET.  Everything that it loads is then in TARGET.
import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import esbuild from "esbuild";

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, "..", "..");
const PYODIDE = path.join(HERE, "node_modules", "pyodide");
const [wheels, target] = process.argv.slice(2).map((each) => path.resolve(each));
const packages = path.join(target, "packages");
fs.mkdirSync(packages, { recursive: true });

// --- Python: the standard library and the wheels, compiled by the Pyodide that will run them -----

let compiler;

async function compiling() {
  if (!compiler) {
    const { loadPyodide } = await import("pyodide");
    const python = await loadPyodide();
    python.runPython(fs.readFileSync(path.join(HERE, "compile.py"), "utf8"));
    compiler = python;
  }
  return compiler;
}

// The names of an archive's compiled parts, one or two, which are those of what is in it: it is
// compiled once.
async function compiled(file, ...names) {
  const data = fs.readFileSync(file);
  const digest = createHash("sha256").update(data).digest("hex").slice(0, 12);
  const parts = names.map((name) => `${name}-${digest}.zip`);
  if (!parts.every((part) => fs.existsSync(path.join(packages, part)))) {
    const python = await compiling();
    python.FS.writeFile("/source.zip", data);
    const made = python.globals.get(names.length > 1 ? "split_archive" : "compile_archive");
    const targets = parts.map((part) => `/${part}`);
    made("/source.zip", ...targets);
    parts.forEach((part, place) => {
      fs.writeFileSync(path.join(packages, part), python.FS.readFile(targets[place]));
    });
  }
  return parts;
}

function wheel(name) {
  const start = `${name.replace("-", "_")}-`;
  const found = fs.readdirSync(wheels).filter((f) => f.startsWith(start) && f.endsWith(".whl"));
  if (found.length !== 1) throw new Error(`${wheels} has ${found.length} wheels of ${name}`);
  return path.join(wheels, found[0]);
}

const flint = wheel("python-flint");
const [library] = await compiled(path.join(PYODIDE, "python_stdlib.zip"), "python");
const [first, ...rest] = await compiled(wheel("srgc"), "srgc-first", "srgc-rest");
for (const name of ["attrs", "click", "lsprotocol"]) {
  rest.push(...(await compiled(wheel(name), name)));
}
const archives = {
  library,
  first,
  rest,
  flint: path.basename(flint),
};
fs.copyFileSync(flint, path.join(packages, archives.flint));
const kept = new Set([library, first, ...rest, archives.flint]);
for (const file of fs.readdirSync(packages)) {
  if (!kept.has(file)) fs.rmSync(path.join(packages, file));
}
fs.mkdirSync(path.join(target, "pyodide"), { recursive: true });
for (const file of ["pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "pyodide-lock.json"]) {
  fs.copyFileSync(path.join(PYODIDE, file), path.join(target, "pyodide", file));
}

// --- The shipped examples ------------------------------------------------------------------------

function specs(folder) {
  const place = path.join(ROOT, folder);
  const files = fs.readdirSync(place).filter((file) => file.endsWith(".srg")).sort();
  return files.map((file) => ({
    name: file.replace(/\.srg$/, ""),
    text: fs.readFileSync(path.join(place, file), "utf8"),
  }));
}

const readme = fs.readFileSync(path.join(ROOT, "README.md"), "utf8");
const examples = [
  { group: "README", specs: [{ name: "fetch", text: /^```srg fetch.srg\n(.*?)^```$/ms.exec(readme)[1] }] },
  { group: "srgc new", specs: specs("srgc/starters") },
  { group: "specs", specs: specs("specs") },
];
fs.writeFileSync(path.join(target, "examples.json"), JSON.stringify(examples));

// --- The page, with the licences of what is in it ------------------------------------------------

for (const file of fs.readdirSync(target)) {
  if (file.endsWith(".js")) fs.rmSync(path.join(target, file));
}
const bundled = esbuild.buildSync({
  entryPoints: ["src/app.js", "src/worker.js"],
  absWorkingDir: HERE,
  outdir: target,
  bundle: true,
  splitting: true,
  minify: true,
  format: "esm",
  target: "es2022",
  define: { ARCHIVES: JSON.stringify(archives) },
  metafile: true,
});
for (const file of ["index.html", "style.css"]) {
  fs.copyFileSync(path.join(HERE, "src", file), path.join(target, file));
}
fs.copyFileSync(
  path.join(HERE, "node_modules", "vscode-oniguruma", "release", "onig.wasm"),
  path.join(target, "onig.wasm"),
);

const folders = new Set(["node_modules/pyodide", "node_modules/vscode-oniguruma"]);
for (const file of Object.keys(bundled.metafile.inputs)) {
  const [folder] = /^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file) ?? [];
  if (folder) folders.add(folder);
}
const notices = [...folders].sort().map((folder) => {
  const place = path.join(HERE, folder);
  const { name, version, license } = JSON.parse(fs.readFileSync(path.join(place, "package.json")));
  const file = fs.readdirSync(place).find((entry) => /^licen[cs]e/i.test(entry));
  const text = file ? fs.readFileSync(path.join(place, file), "utf8").trim() : "";
  return `${name} ${version} (${license})\n\n${text}\n`;
});
notices.push("@viz-js/viz has Graphviz in it (EPL-2.0), and Pyodide has CPython (PSF-2.0).\n");
notices.push("The archives in packages/ have their licences in their folders *.dist-info.\n");
fs.writeFileSync(path.join(target, "licences.txt"), notices.join(`\n${"-".repeat(80)}\n\n`));
