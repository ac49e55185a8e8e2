"use strict";

// What must be looked over as a whole, so that a brace or a keyword in it does not count.
const PIECES = /\/\/[^\n]*|\/\*[^]*?(?:\*\/|$)|"[^"\n]*"|'[^'\n]*'|[{}]|[A-Za-z_][A-Za-z0-9_]*|[^\s]/g;

/**
 * The names of the tasks of a file, in their order. A task begins outside of all braces; `task` is
 * a keyword only there.
 *
 * @param {string} text the text of an .srg file, right or wrong
 * @returns {string[]}
 */
function taskNames(text) {
  const names = [];
  let depth = 0;
  let before = ["", ""];
  for (const [piece] of text.matchAll(PIECES)) {
    if (/^\/[/*]/.test(piece)) continue;
    if (piece === "{") {
      if (depth === 0 && before[0] === "task" && /^\w+$/.test(before[1])) names.push(before[1]);
      depth += 1;
    } else if (piece === "}") {
      depth = Math.max(0, depth - 1);
    }
    before = [before[1], piece];
  }
  return names;
}

module.exports = { taskNames };
