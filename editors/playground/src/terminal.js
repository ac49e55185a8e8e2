// What srgc prints for a terminal, as elements; no text is ever read as HTML.

const STYLES = { 1: "bold", 31: "red", 33: "yellow", 36: "cyan" };
const EXCERPT = /^ *\d* +\| /;
const PIECE = /\x1b\[([\d;]*)m|spec\.srg:(\d+):(\d+)|\bSRG\d{4}\b/g;

function button(text, press, label) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.title = label;
  made.addEventListener("click", press);
  return made;
}

// Colours become classes, codes and places of the spec buttons; lines of the spec with their carets
// are scrolled, and all others wrapped.
export function terminal(text, { explain, show }) {
  let styles = "";

  function row(line) {
    const made = document.createElement("div");
    let end = 0;
    const add = (child) => {
      if (!styles) return made.append(child);
      const span = document.createElement("span");
      span.className = styles;
      span.append(child);
      return made.append(span);
    };
    for (const found of line.matchAll(PIECE)) {
      if (found.index > end) add(line.slice(end, found.index));
      end = found.index + found[0].length;
      const [piece, style, number, column] = found;
      if (style !== undefined) styles = style.split(";").map((each) => STYLES[each] ?? "").join(" ").trim();
      else if (number) add(button(piece, () => show(Number(number), Number(column)), "Show in the editor"));
      else add(button(piece, () => explain(piece), `Explain ${piece}`));
    }
    if (end < line.length) add(line.slice(end));
    if (!made.hasChildNodes()) made.append(document.createElement("br"));
    return made;
  }

  const made = document.createDocumentFragment();
  let excerpt = null;
  for (const line of text.replace(/\n$/, "").split("\n")) {
    if (!EXCERPT.test(line)) {
      excerpt = null;
      made.append(row(line));
      continue;
    }
    if (!excerpt) {
      excerpt = document.createElement("div");
      excerpt.className = "excerpt";
      made.append(excerpt);
    }
    excerpt.append(row(line));
  }
  return made;
}
