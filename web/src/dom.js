// Elements of the page.  Texts become text nodes: nothing of a model is parsed as markup.

/** An element with properties or attributes, and with what is inside of it. */
export function el(tag, set = {}, ...inside) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(set)) {
    if (key in element && key !== 'list') element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...inside.filter(x => x != null));
  return element;
}

export const button = (textContent, title, onclick) =>
  el('button', { type: 'button', textContent, title, onclick });
export const small = textContent => el('span', { className: 'small', textContent });
export const text = textContent => el('span', { textContent });

export function swatch(color) {
  const mark = el('i', { className: 'swatch' });
  mark.style.background = color;
  return mark;
}

/** The value of a variable of the style, such as --ink. */
export const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** A number as it is shown beside a name. */
export const shown = (x, digits) => (Number.isFinite(x) ? String(+x.toPrecision(digits)) : '\u2013');
