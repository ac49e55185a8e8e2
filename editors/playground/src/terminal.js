// What srgc prints for a terminal, as elements; no text is ever read as HTML.

const STYLES = { 1: "bold", 31: "red", 33: "yellow", 36: "cyan" };
const PIECE = /\x1b\[([\d;]*)m|spec\.srg:(\d+):(\d+)|\bSRG\d{4}\b/g;

function button(text, press, label) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.title = label;
  made.addEventListener("click", press);
  return made;
}

// Colours become classes, codes and places of the spec buttons.
export function terminal(text, { explain, show }) {
  const made = document.createDocumentFragment();
  let styles = "";
  let end = 0;
  const add = (child) => {
    if (!styles) return made.append(child);
    const span = document.createElement("span");
    span.className = styles;
    span.append(child);
    return made.append(span);
  };
  for (const found of text.matchAll(PIECE)) {
    if (found.index > end) add(text.slice(end, found.index));
    end = found.index + found[0].length;
    const [piece, style, line, column] = found;
    if (style !== undefined) styles = style.split(";").map((each) => STYLES[each] ?? "").join(" ").trim();
    else if (line) add(button(piece, () => show(Number(line), Number(column)), "Show in the editor"));
    else add(button(piece, () => explain(piece), `Explain ${piece}`));
  }
  if (end < text.length) add(text.slice(end));
  return made;
}
