"use strict";

const fs = require("node:fs");
const path = require("node:path");

/**
 * Which `srgc` to run: that of the setting, else that of `.venv` in a workspace folder, else that
 * of PATH. A setting that names nothing is a mistake to be told of, not one to pass over.
 *
 * @param {object} where
 * @param {string} where.setting the setting `srgc.path`; empty if it is not set
 * @param {string[]} where.folders the workspace folders, the one of the file first
 * @param {Record<string, string | undefined>} where.env
 * @param {string} where.home the user's folder, for `~`
 * @param {string} where.platform as `process.platform`
 * @param {(file: string) => boolean} [where.isProgram]
 * @returns {{ path: string, from: "setting" | "venv" | "PATH" } | { missing: string }}
 */
function findSrgc({ setting, folders, env, home, platform, isProgram = isExecutable }) {
  const paths = platform === "win32" ? path.win32 : path.posix;
  const written = setting.trim();
  if (written) {
    const named = absolute(written, folders, home, paths);
    return isProgram(named)
      ? { path: named, from: "setting" }
      : { missing: `The setting srgc.path names ${named}, which is not a program.` };
  }
  const inside = platform === "win32" ? ["Scripts", "srgc.exe"] : ["bin", "srgc"];
  for (const folder of folders) {
    const own = paths.join(folder, ".venv", ...inside);
    if (isProgram(own)) return { path: own, from: "venv" };
  }
  // Entries that are not absolute would mean the folder that happens to be open.
  for (const entry of searchPath(env, platform).filter((folder) => paths.isAbsolute(folder))) {
    const installed = paths.join(entry, inside[1]);
    if (isProgram(installed)) return { path: installed, from: "PATH" };
  }
  return { missing: "srgc was found neither in .venv of the workspace nor on PATH." };
}

/** The setting as an absolute path: `~` and `${workspaceFolder}` stand for their folders. */
function absolute(written, folders, home, paths) {
  const first = folders[0] ?? home;
  const expanded = written
    .replace(/^~(?=$|[\\/])/, () => home)
    .replaceAll("${workspaceFolder}", () => first);
  return paths.resolve(first, expanded);
}

/** The entries of PATH; the name of the variable has any case on Windows. */
function searchPath(env, platform) {
  const key =
    platform === "win32" ? Object.keys(env).find((name) => name.toUpperCase() === "PATH") : "PATH";
  return ((key && env[key]) || "").split(platform === "win32" ? ";" : ":").filter(Boolean);
}

/** Whether a file is there and may be run. */
function isExecutable(file) {
  try {
    fs.accessSync(file, fs.constants.X_OK);
    return fs.statSync(file).isFile();
  } catch {
    return false;
  }
}

module.exports = { findSrgc, isExecutable };
