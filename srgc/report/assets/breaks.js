// Writes a text so that long names in it may be broken between their words, as report/word_breaks.py has it.
const srgcWrite = (function () {
  "use strict";
  const LONG = /[A-Za-z_][\w./]{13,}/g;
  const BETWEEN = /(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[_./])(?=\w)/;

  return function (mark, says) {
    const parts = says.replace(LONG, (name) => name.split(BETWEEN).join("\u0000")).split("\u0000");
    mark.replaceChildren(...parts.flatMap((part, i) => (i ? [document.createElement("wbr"), part] : [part])));
  };
})();
