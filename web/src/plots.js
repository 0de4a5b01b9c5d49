// Plots beside the scene, with a time cursor and the values at the time.
import uPlot from 'uplot';
import { channel, page, times as timesOf } from './data.js';
import { css, el, shown, small, swatch, text } from './dom.js';

const PALETTE = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#8f6bb3', '#7f7f7f'];
const HEIGHT = 132;
const OPEN = 3; // panels that are open at first

export class Plots {
  constructor(side, clock) {
    this.clock = clock;
    this.made = [];
    this.times = page.times.map((c, i) => Array.from(timesOf(c, page.points[i])));
    page.panels.forEach((panel, k) => this.addPanel(side, panel, k));
  }

  /** A panel whose plot is made when it is opened. */
  addPanel(side, panel, k) {
    const body = el('div', { className: 'plot' });
    const title =
      (panel.title || panel.columns.map(c => c.name).join(', ')) + (panel.unit ? ` [${panel.unit}]` : '');
    const open = k < OPEN && !panel.folded && !panel.log;
    const box = el('details', { open }, el('summary', { textContent: title }), body);
    side.append(box);
    let made = false;
    const make = () => {
      if (made || !box.open) return;
      made = true;
      this.makePlot(panel, body);
    };
    box.addEventListener('toggle', make);
    requestAnimationFrame(make);
  }

  makePlot(panel, body) {
    const columns = panel.columns.map((c, j) => ({
      ...c,
      color: PALETTE[j % PALETTE.length],
      values: c.y.map((y, i) => this.column(y, page.points[i])),
    }));
    const lines = columns.flatMap(c => c.values.map((values, i) => [this.times[i], values, c.color, i]));
    const several = page.runs.length > 1;
    const series = lines.map(([, , stroke, i]) => ({
      stroke,
      width: i ? 1 : 1.6,
      pxAlign: 0,
      dash: i ? [4, 3] : undefined,
      points: { show: false },
      spanGaps: several,
    }));
    const data = several
      ? uPlot.join(lines.map(line => line.slice(0, 2)))
      : [this.times[0], ...lines.map(l => l[1])];
    const plot = new uPlot(this.options(panel, columns, body, [{}, ...series]), data, body);
    const cursor = el('div', { className: 'now' });
    plot.over.append(cursor);
    const seek = e => {
      if (e.buttons & 1)
        this.clock.halt(plot.posToVal(e.clientX - plot.over.getBoundingClientRect().left, 'x'));
    };
    plot.over.addEventListener('pointerdown', seek);
    plot.over.addEventListener('pointermove', seek);
    const cells = columns.map(() => el('b'));
    const rows = columns.map((c, j) => el('li', {}, swatch(c.color), text(c.name), cells[j], small(c.about)));
    if (panel.more) rows.push(el('li', { className: 'small', textContent: `and ${panel.more} more` }));
    body.append(el('ul', { className: 'columns' }, ...rows));
    this.made.push({ plot, cursor, cells, columns, body });
    this.clock.touch();
  }

  column(y, n) {
    const found = channel(y, n);
    return found.fixed ? new Array(n).fill(found.value) : Array.from(found.x);
  }

  options(panel, columns, body, series) {
    const grid = { stroke: () => css('--grid'), width: 1 };
    const axis = { stroke: () => css('--ink'), grid, ticks: grid, font: '11px system-ui, sans-serif' };
    const number = x => (Math.abs(x) >= 1e5 || (x && Math.abs(x) < 1e-3) ? x.toExponential(0) : shown(x, 6));
    const values = (_, ticks) => ticks.map(x => (x === null ? '' : number(x)));
    const range = (_, low, high) => this.range(columns, low, high);
    return {
      width: body.clientWidth || 320,
      height: HEIGHT,
      pxAlign: 0,
      series,
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
      scales: { x: { time: false, range: [0, this.clock.end] }, y: panel.log ? { distr: 3 } : { range } },
      axes: [
        { ...axis, size: 30 },
        { ...axis, size: 56, space: 26, values },
      ],
    };
  }

  /** The range of an axis: a change that is round-off does not fill it. */
  range(columns, low, high) {
    if (low == null) return [0, 1];
    const middle = (low + high) / 2;
    const flat = columns.every(c => c.flat);
    const size = Math.max(Math.abs(low), Math.abs(high), ...columns.map(c => c.size ?? 0));
    const half = Math.max(((high - low) / 2) * 1.08, flat ? 0.6 * size : 0) || 1;
    return [middle - half, middle + half];
  }

  /** Move the cursors. */
  move(t) {
    for (const { plot, cursor } of this.made) {
      cursor.style.transform = `translateX(${plot.valToPos(t, 'x').toFixed(1)}px)`;
    }
  }

  /** Show the values of the first run at the time. */
  tell(t) {
    const after = this.times[0].findIndex(x => x > t);
    const i = after < 0 ? this.times[0].length - 1 : Math.max(0, after - 1);
    for (const { columns, cells } of this.made) {
      columns.forEach((c, k) => (cells[k].textContent = shown(c.values[0][i], 5)));
    }
  }

  redraw() {
    this.made.forEach(({ plot }) => plot.redraw(false));
  }

  resize() {
    this.made.forEach(({ plot, body }) => plot.setSize({ width: body.clientWidth || 320, height: HEIGHT }));
  }
}
