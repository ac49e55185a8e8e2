"use strict";

const vscode = require("vscode");

/**
 * Show a message; the action that was chosen, or undefined.
 *
 * @param {"information" | "warning" | "error"} level
 * @param {string} text
 * @param {string[]} actions
 */
function show(level, text, actions) {
  const { showInformationMessage, showWarningMessage, showErrorMessage } = vscode.window;
  const shown = {
    information: showInformationMessage,
    warning: showWarningMessage,
    error: showErrorMessage,
  };
  return shown[level](text, ...actions);
}

module.exports = { show };
