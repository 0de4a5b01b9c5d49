// The page: a model on the left; its motion, parameters and equations on the right.
import katex from 'katex';
import { createEditor } from './editor.mjs';
import { Engine } from './engine.mjs';
import { read, write } from './links.mjs';

const FIRST = 'classic/double_pendulum';
const NEW = 'new';
const REST = { check: 60, fixes: 400, run: 500 }; // ms without a key
const QUICK = 2; // s: a model that takes longer is run by the button alone

const $ = id => document.getElementById(id);
const el = (tag, more = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), more);
  made.append(...children);
  return made;
};

const state = { scene: '', parameters: {}, cost: 0, shown: '', sliders: '', opened: FIRST };
const dark = matchMedia('(prefers-color-scheme: dark)');

const engine = new Engine((what, kind) => {
  const running = what === 'busy' && kind === 'run';
  document.body.dataset.state = running ? 'running' : what === 'busy' ? 'ready' : what;
  $('run').textContent = running ? 'Stop' : 'Run';
  $('run').disabled = what === 'starting';
  $('state').textContent = { starting: 'starting Python \u2026', ready: '', busy: running ? 'running \u2026' : '' }[what] ?? what;
});

// -- the model
const editor = createEditor($('editor'), {
  ask: (kind, more) => engine.ask(kind, more),
  run: () => run(true),
  change() {
    state.parameters = {};
    soon('check', check);
  },
});

const timers = {};
function soon(name, job) {
  clearTimeout(timers[name]);
  timers[name] = setTimeout(job, REST[name]);
}

/** Look at the text, and if it rests without errors, run it. */
async function check() {
  clearTimeout(timers.run);
  const text = editor.text();
  const quick = await engine.ask('check', { text });
  if (!quick?.faults || text !== editor.text()) return;
  tell(text.trim() ? quick.faults : []);
  if (!text.trim()) return;
  if (quick.faults.length) soon('fixes', () => repair(text));
  if (wrong(quick.faults)) return;
  soon('run', async () => {
    const whole = await engine.ask('whole', { text });
    if (!whole?.faults || text !== editor.text()) return;
    tell(whole.faults);
    if (!wrong(whole.faults) && state.cost < QUICK) run();
  });
}

/** Offer tried fixes beside the first faults. */
async function repair(text) {
  const found = await engine.ask('fixes', { text });
  if (text !== editor.text()) return;
  found?.fixes?.forEach((fix, k) => {
    const row = $('faults').children[k];
    if (fix) row?.append(el('button', { className: 'fix', onclick: () => editor.apply(fix.edits) }, ...spelt(fix.title)));
  });
}

/** A message, its code between backquotes as such. */
const spelt = text => text.split('`').map((part, k) => (k % 2 ? el('code', { textContent: part }) : part));
const wrong = faults => faults.some(fault => fault.severity === 'error');

function tell(faults) {
  editor.mark(faults);
  $('faults').replaceChildren(
    ...faults.map(fault => {
      const place = fault.line ? `line ${fault.line}` : '';
      const go = () => fault.from !== undefined && editor.go(fault);
      return el(
        'div',
        { className: fault.severity },
        el('button', { textContent: [place, fault.code].filter(Boolean).join(' \u00b7 '), onclick: go }),
        el('span', {}, ...spelt(fault.message)),
        ...(fault.remedy ? [el('span', { className: 'help' }, ...spelt(fault.remedy))] : []),
      );
    }),
  );
}

// -- the motion
async function run(asked = false) {
  if (document.body.dataset.state === 'running' && asked) return engine.stop();
  clearTimeout(timers.run);
  const text = editor.text();
  if (!text.trim()) return;
  if (asked) part('motion');
  const found = await engine.ask('run', { text, scene: state.scene, parameters: state.parameters });
  if (!found || text !== editor.text()) return;
  if (found.stopped || found.broken) {
    state.cost = Infinity;
    $('summary').textContent = found.broken ?? 'Stopped.';
    return;
  }
  if (found.faults) {
    tell(found.faults);
    if (asked) part('model');
    return;
  }
  draw(found);
}

function draw(found) {
  state.cost = found.all_s;
  state.scene = found.scene;
  document.title = `${found.model} \u00b7 lagc playground`;
  $('scenes').hidden = found.scenes.length < 2;
  $('scenes').replaceChildren(
    ...found.scenes.map(name => el('option', { value: name, textContent: `scene ${name}`, selected: name === found.scene })),
  );
  sliders(found);
  if (found.page) film(found.page, `${found.model} ${found.scene}`);
  const accuracy = found.accuracy ? `estimated error ${found.accuracy.toExponential(0)}` : 'error not estimated';
  const facts = [`${+found.end.toPrecision(6)} s of motion`, accuracy, `${found.steps} steps in ${found.run_s.toFixed(2)} s`];
  $('summary').textContent = found.status === 'ok' ? facts.join(' \u00b7 ') : found.message;
  $('summary').className = found.status === 'ok' ? '' : 'failed';
  $('count').textContent = found.count;
  $('formulas').replaceChildren(
    ...found.latex.map(row => {
      const made = el('div');
      katex.render(row, made, { displayMode: true, throwOnError: false, strict: false });
      return made;
    }),
  );
}

/** Show another film; it goes on at the time of the one that it replaces, if that was of the same scene. */
function film(html, name) {
  const old = $('frames').lastElementChild;
  const made = el('iframe', { title: 'the motion', srcdoc: html });
  made.onload = () => {
    const { lagcAnimation: next, document: page } = made.contentWindow;
    const before = old?.contentWindow?.lagcAnimation;
    page.querySelector('header').hidden = true;
    next.theme(dark.matches ? 'dark' : 'light');
    if (before && state.shown === name) {
      next.seek(before.state.t);
      next.play(before.state.playing);
    }
    state.shown = name;
    made.className = 'shown';
    for (const other of [...$('frames').children]) if (other !== made) other.remove();
  };
  $('frames').append(made);
}
dark.addEventListener('change', () =>
  $('frames').lastElementChild.contentWindow?.lagcAnimation?.theme(dark.matches ? 'dark' : 'light'),
);

// -- the parameters
const shown = x => String(+x.toPrecision(4));

function sliders(found) {
  const key = JSON.stringify(found.sliders);
  if (key === state.sliders) return;
  state.sliders = key;
  $('parameters').hidden = !found.sliders.length;
  $('sliders').replaceChildren(
    ...found.sliders.map(({ name, unit, value, low, high, about }) => {
      const now = state.parameters[name] ?? value;
      const output = el('output', { textContent: shown(now) });
      const input = el('input', { type: 'range', min: 0, max: 1000, value: (1000 * (now - low)) / (high - low) });
      input.setAttribute('aria-label', name);
      input.oninput = () => set(low + ((high - low) * input.value) / 1000);
      const set = x => {
        state.parameters[name] = +x.toPrecision(4);
        output.textContent = shown(x);
        run();
      };
      const label = el('span', { textContent: name, title: about || name });
      label.ondblclick = () => {
        input.value = (1000 * (value - low)) / (high - low);
        set(value);
      };
      return el('label', {}, label, input, output, el('small', { textContent: unit }));
    }),
  );
}

// -- scenes, models, links, parts
function chooseScene(name) {
  state.scene = name;
  state.parameters = {};
  state.sliders = '';
  run();
}
$('scenes').onchange = event => chooseScene(event.target.value);
$('run').onclick = () => run(true);

function part(name) {
  document.querySelector('main').dataset.part = name;
  for (const button of document.querySelectorAll('nav button'))
    button.setAttribute('aria-pressed', button.dataset.part === name);
}
for (const button of document.querySelectorAll('nav button')) button.onclick = () => part(button.dataset.part);

const byFolder = Object.groupBy(Object.keys(self.MODELS), name => name.split('/')[0]);
$('models').append(
  el('option', { value: NEW, textContent: 'New model' }),
  ...Object.entries(byFolder).map(([label, names]) =>
    el('optgroup', { label }, ...names.map(value => el('option', { value, textContent: value.split('/')[1].replaceAll('_', ' ') }))),
  ),
);

function open({ model, text, scene = '', parameters = {} }) {
  Object.assign(state, { scene, cost: 0, shown: '', sliders: '' });
  $('models').value = model ?? NEW;
  editor.write(text ?? self.MODELS[model] ?? '');
  state.parameters = parameters;
}
$('models').onchange = event => {
  history.replaceState(null, '', `#model=${event.target.value}`);
  open({ model: event.target.value });
  part('model');
};
$('share').onclick = async () => {
  const text = editor.text();
  const model = Object.keys(self.MODELS).find(name => self.MODELS[name] === text);
  const scene = $('scenes').hidden ? '' : state.scene;
  history.replaceState(null, '', await write({ model, text, scene, parameters: state.parameters }));
  const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
  $('share').textContent = copied ? 'Link copied' : 'Link in the address';
  setTimeout(() => ($('share').textContent = 'Share'), 2000);
};
const follow = async () => open((await read(location.hash, self.MODELS)) ?? { model: FIRST });
addEventListener('hashchange', follow);
part('model');
follow();
self.playground = { engine, editor, state };
