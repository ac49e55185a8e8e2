// The colours of the editor, by the grammar that all editors share, in the tokeniser of VS Code.

import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";
import * as oniguruma from "vscode-oniguruma";
import * as textmate from "vscode-textmate";
import language from "../../vscode/language-configuration.json";
import srg from "../../vscode/syntaxes/srg.tmLanguage.json";

const NAMES = [
  [/^comment/, "comment"],
  [/^string/, "string"],
  [/^constant/, "number"],
  [/^invalid/, "invalid"],
  [/^keyword\.operator/, "operator"],
  [/^keyword\.other\.unit/, "unit"],
  [/^(?:keyword|storage)/, "keyword"],
  [/^(?:support|entity\.name)/, "definition"],
];
const TOKENS = {
  comment: tags.comment,
  string: tags.string,
  number: tags.number,
  invalid: tags.invalid,
  operator: tags.operator,
  unit: tags.unit,
  keyword: tags.keyword,
  definition: tags.typeName,
};
const STYLE = HighlightStyle.define(
  Object.entries(TOKENS).map(([name, tag]) => ({ tag, class: `srg-${name}` })),
);

function nameOf(scopes) {
  const scope = scopes.at(-1);
  return NAMES.find(([pattern]) => pattern.test(scope))?.[1] ?? null;
}

export async function highlighting() {
  await oniguruma.loadWASM(await fetch(new URL("onig.wasm", import.meta.url)));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async (scope) => (scope === srg.scopeName ? srg : null),
  });
  const grammar = await registry.loadGrammar(srg.scopeName);
  const read = (line, state) => {
    const found = grammar.tokenizeLine(line, state.stack);
    state.stack = found.ruleStack;
    state.tokens = found.tokens;
  };
  const parser = StreamLanguage.define({
    name: "srg",
    tokenTable: TOKENS,
    languageData: {
      commentTokens: { line: "//", block: { open: "/*", close: "*/" } },
      closeBrackets: { brackets: language.brackets.map(([open]) => open) },
    },
    startState: () => ({ stack: textmate.INITIAL, tokens: [] }),
    copyState: (state) => ({ ...state }),
    blankLine: (state) => read("", state),
    token(stream, state) {
      if (stream.sol()) read(stream.string, state);
      const token = state.tokens.find((each) => each.endIndex > stream.pos);
      const end = token?.endIndex ?? stream.string.length;
      stream.pos = Math.max(stream.pos + 1, Math.min(end, stream.string.length));
      return token ? nameOf(token.scopes) : null;
    },
  });
  return [parser, syntaxHighlighting(STYLE)];
}
