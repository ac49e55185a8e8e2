"use strict";

const assert = require("node:assert/strict");
const test = require("node:test");
const { findSrgc, isExecutable } = require("../../src/find_srgc");

/** What is found where exactly these programs are. */
function found(programs, where = {}) {
  return findSrgc({
    setting: "",
    folders: ["/project", "/other"],
    env: { PATH: "/usr/bin:/opt/bin" },
    home: "/home/me",
    platform: "linux",
    isProgram: (file) => programs.includes(file),
    ...where,
  });
}

test("the setting, then .venv of the workspace, then PATH", () => {
  const all = ["/tools/srgc", "/project/.venv/bin/srgc", "/opt/bin/srgc"];
  assert.deepEqual(found(all, { setting: " /tools/srgc " }), { path: "/tools/srgc", from: "setting" });
  assert.deepEqual(found(all), { path: "/project/.venv/bin/srgc", from: "venv" });
  assert.deepEqual(found(["/opt/bin/srgc"]), { path: "/opt/bin/srgc", from: "PATH" });
});

test("any folder of the workspace may have the .venv, the first before the others", () => {
  const second = "/other/.venv/bin/srgc";
  assert.deepEqual(found([second, "/usr/bin/srgc"]), { path: second, from: "venv" });
  assert.equal(found([second, "/project/.venv/bin/srgc"]).path, "/project/.venv/bin/srgc");
});

test("a setting that names nothing is told of and not passed over", () => {
  const answer = found(["/usr/bin/srgc"], { setting: "/gone/srgc" });
  assert.match(answer.missing, /srgc\.path names \/gone\/srgc/);
});

test("the setting may begin with ~ or the workspace folder, or be relative to it", () => {
  const path = (setting, program) => found([program], { setting }).path;
  assert.equal(path("~/bin/srgc", "/home/me/bin/srgc"), "/home/me/bin/srgc");
  assert.equal(path("${workspaceFolder}/e/srgc", "/project/e/srgc"), "/project/e/srgc");
  assert.equal(path("e/srgc", "/project/e/srgc"), "/project/e/srgc");
});

test("entries of PATH that are not absolute would mean the open folder: they are left out", () => {
  const env = { PATH: ".::bin:/usr/bin" };
  assert.equal(found(["srgc", "./srgc", "bin/srgc", "/usr/bin/srgc"], { env }).path, "/usr/bin/srgc");
  assert.ok("missing" in found(["srgc", "./srgc", "bin/srgc"], { env }));
});

test("nowhere", () => {
  assert.match(found([]).missing, /neither in \.venv .* nor on PATH/);
  assert.ok("missing" in found([], { folders: [], env: {} }));
});

test("on Windows", () => {
  const where = { platform: "win32", folders: ["C:\\project"], home: "C:\\me", env: { Path: "D:\\bin;rel" } };
  const own = "C:\\project\\.venv\\Scripts\\srgc.exe";
  assert.deepEqual(found([own], where), { path: own, from: "venv" });
  assert.deepEqual(found(["D:\\bin\\srgc.exe"], where), { path: "D:\\bin\\srgc.exe", from: "PATH" });
});

test("a program is a file that may be run", () => {
  assert.ok(isExecutable(process.execPath));
  assert.ok(!isExecutable(__filename));
  assert.ok(!isExecutable(__dirname));
  assert.ok(!isExecutable(`${__filename}.gone`));
});
