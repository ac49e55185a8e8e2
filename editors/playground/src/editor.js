// The editor: CodeMirror, with findings, completion and hovers as the language server has them.

import {
  acceptCompletion, autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap, snippet,
} from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { bracketMatching, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { Compartment, EditorState } from "@codemirror/state";
import {
  drawSelection, EditorView, highlightActiveLine, hoverTooltip, keymap, lineNumbers,
} from "@codemirror/view";
import { highlighting } from "./highlight.js";

const KINDS = { unit: "constant", module: "class", field: "property", file: "text", folder: "text" };
const SEVERITIES = { error: "error", warning: "warning", note: "info" };

const theme = EditorView.theme({
  "&": { backgroundColor: "var(--paper)", color: "var(--ink)", fontSize: "0.85rem" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.45" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--faint)", border: "none" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--accent) 6%, transparent)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": {
    backgroundColor: "var(--selected)",
  },
  ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--ink)", border: "1px solid var(--line)" },
  ".cm-tooltip-autocomplete > ul > li[aria-selected]": {
    backgroundColor: "var(--accent)", color: "var(--paper)",
  },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "var(--mono)", maxWidth: "min(90vw, 40rem)" },
  ".cm-hovered": {
    whiteSpace: "pre-wrap", padding: "0.4rem 0.6rem", maxWidth: "min(90vw, 36rem)", maxHeight: "40vh",
    overflow: "auto", fontFamily: "var(--mono)", fontSize: "0.8rem",
  },
  ".cm-diagnostic": { whiteSpace: "pre-wrap", maxWidth: "min(90vw, 36rem)" },
});

// A snippet of the Language Server Protocol as one of CodeMirror's.
export function template(body) {
  return body
    .replace(/\$\{(\d+)\|([^,|]*)[^|]*\|\}/g, "${$1:$2}")
    .replace(/\$\{0:([^}]*)\}|\$0/g, (_, words) => `\${99:${words ?? ""}}`);
}

function option(offer, rank) {
  return {
    label: offer.label,
    detail: offer.snippet || offer.detail === offer.label ? undefined : offer.detail,
    type: KINDS[offer.kind] ?? offer.kind,
    boost: Math.max(-99, 99 - rank),
    apply: offer.snippet ? snippet(template(offer.insert)) : offer.insert,
  };
}

export class Editor {
  // `ask` asks the engine; `changed` is called after every change; `explain` shows a code.
  constructor(parent, { ask, changed, explain, format }) {
    this.explain = explain;
    const language = new Compartment();
    const completion = async (context) => {
      if (!context.explicit && !context.matchBefore(/[\w"/.]/)) return null;
      const found = await ask({ ask: "complete", text: context.state.doc.toString(), at: context.pos });
      const offers = found?.answer?.offers ?? [];
      if (!offers.length) return null;
      return { from: found.answer.start, options: offers.map(option), validFor: /^\w*$/ };
    };
    const hovered = hoverTooltip(async (view, at) => {
      const found = await ask({ ask: "hover", text: view.state.doc.toString(), at });
      if (!found?.answer) return null;
      const { text, start, end } = found.answer;
      const dom = document.createElement("div");
      dom.className = "cm-hovered";
      dom.textContent = text;
      return { pos: start, end, above: true, create: () => ({ dom }) };
    });
    this.view = new EditorView({
      parent,
      state: EditorState.create({
        extensions: [
          lineNumbers(), lintGutter(), history(), drawSelection(), indentOnInput(), bracketMatching(),
          closeBrackets(), highlightActiveLine(), indentUnit.of("  "), EditorView.lineWrapping,
          autocompletion({ override: [completion] }), hovered, theme, language.of([]),
          keymap.of([
            { key: "Shift-Alt-f", run: () => (format(), true) },
            { key: "Tab", run: acceptCompletion },
            ...closeBracketsKeymap, ...completionKeymap, ...lintKeymap, ...historyKeymap, ...defaultKeymap,
          ]),
          EditorView.contentAttributes.of({
            "aria-label": "Spec", spellcheck: "false", tabindex: "0",
          }),
          EditorView.updateListener.of((update) => update.docChanged && changed()),
        ],
      }),
    });
    highlighting().then(
      (extensions) => this.view.dispatch({ effects: language.reconfigure(extensions) }),
      (error) => console.warn(`no colours: ${error}`),
    );
  }

  get text() {
    return this.view.state.doc.toString();
  }

  set text(text) {
    const { doc } = this.view.state;
    this.view.dispatch({ changes: { from: 0, to: doc.length, insert: text.replace(/^\ufeff/, "") } });
  }

  // Underline findings; `places` has what of the text each is about, or null.
  mark(findings, places) {
    const marked = [];
    findings.forEach(({ severity, message, hint, code }, i) => {
      if (!places[i]) return;
      const [from, to] = places[i].map((at) => Math.min(at, this.view.state.doc.length));
      marked.push({
        from, to, severity: SEVERITIES[severity], source: code,
        message: hint ? `${message}\nhint: ${hint}` : message,
        actions: [{ name: `Explain ${code}`, apply: () => this.explain(code) }],
      });
    });
    this.view.dispatch(setDiagnostics(this.view.state, marked));
  }

  // Put the cursor at a line and a column, both from 1; columns count code points.
  show(number, column) {
    const { doc } = this.view.state;
    const line = doc.line(Math.min(Math.max(number, 1), doc.lines));
    const before = [...line.text].slice(0, column - 1).join("");
    this.view.dispatch({ selection: { anchor: line.from + before.length }, scrollIntoView: true });
    this.view.focus();
  }
}
