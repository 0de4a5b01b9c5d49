// The legend of the scene, the list of events, and what the page states about its accuracy.
import { page } from './data.js';
import { button, el, small, swatch, text } from './dom.js';
import { KINDS, MOST_NAMED, colorOf, hex } from './stage.js';

const MOST_EVENTS = 200;
const PLURAL = { weight: 'weights', load: 'loads', reaction: 'reactions' };

export function legend(stage, clock) {
  const items =
    page.bodies.length > MOST_NAMED ? [] : page.bodies.map((b, k) => bodyItem(stage, clock, b, k));
  if (!items.length) items.push(small(`${page.bodies.length} bodies`));
  if (page.forces.length && stage.newton) {
    const kinds = [...new Set(page.forces.map(f => f.kind))];
    const marks = kinds.flatMap(kind => [swatch(hex(KINDS[kind])), text(PLURAL[kind])]);
    items.push(
      el(
        'span',
        { className: 'item' },
        ...marks,
        small(`${+(1 / stage.newton).toPrecision(2)} N for each m`),
      ),
    );
  }
  for (const run of page.runs.slice(1)) {
    items.push(el('span', { className: 'item' }, swatch('#8886'), text(`faint: ${run.label}`)));
  }
  return el('div', { className: 'legend' }, ...items);
}

/** A button that hides a body or shows it again. */
function bodyItem(stage, clock, body, k) {
  const onclick = event => {
    if (!stage.hidden.delete(k)) stage.hidden.add(k);
    event.currentTarget.classList.toggle('off');
    clock.touch();
  };
  const scale = `${+body.mass.toPrecision(3)} kg${body.shape.true ? '' : ', not to scale'}`;
  const title = `hide or show ${body.name}`;
  return el(
    'button',
    { type: 'button', className: 'item', title, onclick },
    swatch(hex(colorOf(k))),
    text(body.name),
    small(scale),
  );
}

export function eventList(clock) {
  if (!page.events.length) return null;
  const rows = page.events.slice(0, MOST_EVENTS).map(event => {
    const lost =
      event.kind === 'impact'
        ? `${event.impulse?.toPrecision(3)} N s, lost ${event.loss?.toPrecision(2)} J`
        : '';
    return el(
      'li',
      {},
      button(`${event.t.toFixed(4)} s`, 'to this event', () => clock.halt(event.t)),
      text(event.name),
      small(lost),
    );
  });
  return el(
    'details',
    {},
    el('summary', { textContent: `${page.events.length} events` }),
    el('ol', { className: 'events' }, ...rows),
  );
}

export const statement = () =>
  el('p', {
    className: 'small',
    textContent:
      `${page.tool}; between frames the drawing is off by at most ${page.error.toExponential(0)} m. ` +
      'Figures of bodies follow from their inertia and their points.',
  });
