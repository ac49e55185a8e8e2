"use strict";

const { execFile } = require("node:child_process");

/**
 * Run `srgc` to its end without a shell.
 *
 * @param {string} program
 * @param {string[]} args
 * @param {string} cwd
 * @param {AbortSignal} [signal] ends the run
 * @returns {Promise<{ status: number | null, out: string, err: string }>} the status is null where
 *   the program did not start or was ended; `err` then says why
 */
function runSrgc(program, args, cwd, signal) {
  const options = { cwd, signal, maxBuffer: 64 * 1024 * 1024, windowsHide: true };
  return new Promise((resolve) => {
    execFile(program, args, options, (error, out, err) => {
      const status = error ? (typeof error.code === "number" ? error.code : null) : 0;
      resolve({ status, out, err: status === null ? `${err}${error.message}\n` : err });
    });
  });
}

module.exports = { runSrgc };
