"use strict";

// Scripts and styles are those in the page; nothing is loaded from anywhere.
const POLICY =
  "default-src 'none'; img-src data:; font-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

// VS Code styles every page with the colours of its theme; a report has its own paper.
const PLAIN =
  "code, a code { color: inherit; background: none; padding: 0; border-radius: 0; } a:hover { color: inherit; }";

/**
 * A report as the editor shows it: it may load nothing, and its colours are its own.
 *
 * @param {string} html the page that `srgc report` has written
 * @returns {string}
 */
function reportPage(html) {
  const meta = `<meta http-equiv="Content-Security-Policy" content="${POLICY}">`;
  const head = /<head\b[^>]*>/i.exec(html);
  const at = head ? head.index + head[0].length : 0;
  return `${html.slice(0, at)}${meta}<style>${PLAIN}</style>${html.slice(at)}`;
}

module.exports = { PLAIN, POLICY, reportPage };
