"use strict";

// Scripts and styles are those in the page; nothing is loaded from anywhere.
const POLICY =
  "default-src 'none'; img-src data:; font-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/**
 * A report as the editor shows it: it may load nothing.
 *
 * @param {string} html the page that `srgc report` has written
 * @returns {string}
 */
function reportPage(html) {
  const meta = `<meta http-equiv="Content-Security-Policy" content="${POLICY}">`;
  const head = /<head\b[^>]*>/i.exec(html);
  const at = head ? head.index + head[0].length : 0;
  return html.slice(0, at) + meta + html.slice(at);
}

module.exports = { POLICY, reportPage };
