// The editor: CodeMirror with the colours, faults, completion and facts of the language.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, indentWithTab } from '@codemirror/commands';
import {
  bracketMatching,
  HighlightStyle,
  indentOnInput,
  indentService,
  StreamLanguage,
  syntaxHighlighting,
} from '@codemirror/language';
import { lintKeymap, setDiagnostics } from '@codemirror/lint';
import { EditorState } from '@codemirror/state';
import {
  drawSelection,
  EditorView,
  highlightActiveLine,
  hoverTooltip,
  keymap,
  lineNumbers,
  placeholder,
} from '@codemirror/view';
import { tags } from '@lezer/highlight';

// -- offsets: Python counts characters, a page counts 16-bit units
const wide = /[\ud800-\udbff]/;
export const toUnits = (text, n) => (wide.test(text) ? [...text].slice(0, n).join('').length : n);
export const toCharacters = (text, n) => (wide.test(text) ? [...text.slice(0, n)].length : n);

// -- colours: the table of `lagc.editor.colours`, whose rules are tried in turn
const STYLES = {
  comment: 'comment',
  string: 'string',
  'constant.numeric': 'number',
  'constant.other.unit': 'unit',
  'constant.language': 'keyword',
  'keyword.control': 'keyword',
  'keyword.operator.word': 'keyword',
  storage: 'keyword',
  'support.type': 'typeName',
  support: 'variableName.function',
};
const style = scope => Object.entries(STYLES).find(([name]) => scope.startsWith(name))?.[1] ?? null;
const rules = self.COLOURS.map(([scopes, pattern]) => [scopes.map(style), new RegExp(pattern, 'y')]);

const language = StreamLanguage.define({
  startState: () => ({ second: null }), // the length and the style of the second group of a rule
  token(stream, state) {
    if (state.second) {
      const [length, name] = state.second;
      stream.pos += length;
      state.second = null;
      return name;
    }
    if (stream.eatSpace()) return null;
    for (const [[first, second], pattern] of rules) {
      pattern.lastIndex = stream.pos;
      const found = pattern.exec(stream.string);
      if (!found?.[0]) continue;
      stream.pos += (second === undefined ? found[0] : found[1]).length;
      if (second !== undefined && found[2]) state.second = [found[2].length, second];
      return first;
    }
    stream.next();
    return null;
  },
  tokenTable: { unit: tags.unit },
  languageData: { commentTokens: { line: '//' }, indentOnInput: /^\s*end$/ },
});
const colours = HighlightStyle.define(
  [
    [tags.comment, 'comment'],
    [tags.string, 'string'],
    [tags.unit, 'unit'],
    [tags.number, 'number'],
    [tags.keyword, 'keyword'],
    [tags.typeName, 'type'],
    [tags.function(tags.variableName), 'function'],
  ].map(([tag, name]) => ({ tag, class: `lag-${name}` })),
);

/** A line is indented as the one before it, by two more behind the head of a block, by two less at its end. */
const indentation = indentService.of((context, at) => {
  const { doc } = context.state;
  const line = doc.lineAt(at);
  const broken = context.simulatedBreak === at; // Enter: the rest of this line is the next one
  let n = line.number - !broken;
  while (n > 0 && !doc.line(n).text.trim()) n--;
  if (!n) return 0;
  const before = broken && n === line.number ? line.text.slice(0, at - line.from) : doc.line(n).text;
  const opens = /^\s*(?:partial\s+)?(?:model|effect|scene|when|for|if|frame|package)\b[^;]*$/.test(before);
  const closes = /^\s*end\b/.test(broken ? line.text.slice(at - line.from) : line.text);
  return Math.max(0, before.search(/\S/) + 2 * opens - 2 * closes);
});

/** An editor in `parent`; `on.change(text)`, `on.run()`, and `on.ask(kind, more)`, which resolves with answers. */
export function createEditor(parent, on) {
  const complete = async context => {
    const word = context.matchBefore(/\w*/);
    if (!context.explicit && !word.text && !/[.[(\s]$/.test(context.state.sliceDoc(context.pos - 1, context.pos)))
      return null;
    const text = context.state.doc.toString();
    const found = await on.ask('complete', { text, offset: toCharacters(text, context.pos) });
    const options = (found?.offers ?? []).map(({ label, kind, detail }, k) => ({
      label,
      type: kind,
      detail,
      boost: -Math.min(k, 99),
    }));
    return options.length && (context.explicit || word.text) ? { from: word.from, options, validFor: /^\w*$/ } : null;
  };
  const facts = hoverTooltip(async (view, at) => {
    const text = view.state.doc.toString();
    const found = await on.ask('hover', { text, offset: toCharacters(text, at) });
    if (!found?.hover) return null;
    const [pos, end] = [found.hover.from, found.hover.to].map(n => toUnits(text, n));
    const dom = document.createElement('div');
    dom.className = 'fact';
    dom.textContent = found.hover.text.replace(/```\w*\n?/g, '').replace(/`/g, '').trim();
    return { pos, end, above: true, create: () => ({ dom }) };
  });
  const view = new EditorView({
    parent,
    extensions: [
      lineNumbers(),
      history(),
      drawSelection(),
      bracketMatching(),
      closeBrackets(),
      highlightActiveLine(),
      language,
      indentation,
      indentOnInput(),
      syntaxHighlighting(colours),
      autocompletion({ override: [complete], activateOnTypingDelay: 60, icons: false }),
      facts,
      placeholder('model Pendulum "what it is"\n  ...\nend Pendulum;'),
      EditorState.tabSize.of(2),
      EditorView.contentAttributes.of({ 'aria-label': 'the model', spellcheck: 'false', autocapitalize: 'off' }),
      EditorView.updateListener.of(update => update.docChanged && on.change(view.state.doc.toString())),
      keymap.of([
        { key: 'Mod-Enter', run: () => (on.run(), true) },
        ...closeBracketsKeymap,
        ...completionKeymap,
        ...lintKeymap,
        ...historyKeymap,
        ...defaultKeymap,
        indentWithTab,
      ]),
    ],
  });
  return {
    view,
    text: () => view.state.doc.toString(),
    write: text => view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: text } }),
    mark(faults) {
      const text = view.state.doc.toString();
      const placed = faults.filter(fault => fault.from !== undefined);
      const diagnostics = placed.map(fault => {
        const [from, to] = [fault.from, fault.to].map(n => Math.min(text.length, toUnits(text, n)));
        return { from, to: Math.max(from, to), severity: fault.severity, message: fault.message };
      });
      view.dispatch(setDiagnostics(view.state, diagnostics));
    },
    apply(edits) {
      const text = view.state.doc.toString();
      const changes = edits.map(([from, to, insert]) => ({ from: toUnits(text, from), to: toUnits(text, to), insert }));
      view.dispatch({ changes });
      view.focus();
    },
    go(fault) {
      const anchor = toUnits(view.state.doc.toString(), fault.from);
      view.dispatch({ selection: { anchor }, scrollIntoView: true });
      view.focus();
    },
  };
}
