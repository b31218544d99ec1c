// Curves over time, one below the other: one time axis for all, the slider's time as a line, events as dashes.
import uPlot from 'uplot';
import { doubles, floats } from './data.js';
import { element, onSchemeChange, shortNumber, styleColor, tickTexts } from './elements.js';

const sync = uPlot.sync('time');
const seriesColors = () => [1, 2, 3, 4].map((i) => styleColor(`--series-${i}`));

/// Numbers for uPlot: null where there is none.
const points = (values) => Array.from(values, (value) => (Number.isNaN(value) ? null : value));

/// An axis of uPlot in the page's colours; `size` in pixels, more where the texts of the ticks need it.
export function axis(label, size) {
  const faint = styleColor('--faint');
  const letter_px = 7;
  const others_px = 30; // ticks, gaps, and what the label takes of this room
  const longest = (texts) => Math.max(0, ...(texts ?? []).map((it) => it.length));
  return { label, labelSize: 20, stroke: faint, font: '12px system-ui, sans-serif',
    labelFont: '12px system-ui, sans-serif',
    size: (plot, texts, index) => (index === 0 ? size : Math.max(size, others_px + letter_px * longest(texts))),
    values: (plot, marks) => tickTexts(marks),
    grid: { stroke: styleColor('--line'), width: 1 }, ticks: { stroke: styleColor('--line') } };
}

/// A range of values with some air. What changes by less than any sensor shows is level: noise of the arithmetic would
/// fill the plot.
export function valueRange(plot, low, high) {
  if (low === null) return [0, 1];
  return high - low > 1e-6 ? uPlot.rangeNum(low, high, 0.1, true) : [low - 1, high + 1];
}

export class Curves {
  /// `events`: times in s. `onTime` gets the time at which the reader clicks.
  constructor(parent, events, onTime) {
    this.parent = parent;
    this.events = events;
    this.onTime = onTime;
    this.time = 0;
    this.range = [0, 1];
    this.panels = [];
    this.plots = [];
    new ResizeObserver(() => this.#resize()).observe(parent);
    onSchemeChange(() => this.draw());
  }

  /// The panels of the facts; `sparse`: samples that no line joins.
  async add(panels, read, sparse = false) {
    for (const panel of panels) {
      const times = await doubles(panel.times);
      const values = await Promise.all(panel.series.map(async (series) => points(await read(series.block))));
      this.panels.push({ ...panel, data: [Array.from(times), ...values], sparse });
      this.range[1] = Math.max(this.range[1], times[times.length - 1]);
    }
  }

  /// Rows of bands: { name, bands: [[begin, end, state]], color(state), text(state) }.
  addBands(title, rows) {
    this.panels.push({ title, rows });
  }

  draw() {
    for (const plot of this.plots) plot.destroy();
    this.parent.replaceChildren();
    this.plots = this.panels.map((panel) => (panel.rows ? this.#drawBands(panel) : this.#drawPanel(panel)));
  }

  setTime(time) {
    this.time = time;
    for (const plot of this.plots) plot.redraw(false);
  }

  #width() {
    return Math.max(280, this.parent.clientWidth - 20);
  }

  #resize() {
    for (const plot of this.plots) plot.setSize({ width: this.#width(), height: plot.height });
  }

  #options(height) {
    return {
      width: this.#width(),
      height,
      cursor: { sync: { key: sync.key, scales: ['x', null] }, drag: { x: true, y: false }, y: false },
      // All of the run where nothing is zoomed: the last sample of a curve may stand before its end.
      scales: { x: { time: false,
        range: (plot, low, high) => (low === null || this.#isWhole(plot, low, high) ? this.range : [low, high]) } },
      hooks: { draw: [(plot) => this.#drawMarks(plot)], ready: [(plot) => this.#followClicks(plot)] },
    };
  }

  #isWhole(plot, low, high) {
    const [times] = plot.data;
    return low === times[0] && high === times[times.length - 1];
  }

  #drawPanel(panel) {
    const box = this.#box(panel.title, panel.unit === '1' ? '' : panel.unit);
    const colors = seriesColors();
    let truths = 0;
    let estimates = 0;
    const series = panel.series.map((it) => {
      const estimated = (it.column ?? '').startsWith('est_');
      // An angle steps from 180 to -180 degrees: dots, since a line would cross the plot.
      const dots = panel.sparse || it.jump > 0;
      const color = colors[(estimated && !dots ? estimates++ : truths++) % colors.length];
      return { label: it.label, stroke: color, width: 1.5, dash: estimated ? [5, 4] : undefined,
               points: { show: dots, size: panel.sparse ? 8 : 2.5, width: panel.sparse ? 1 : 0, fill: color },
               paths: dots ? () => null : undefined,
                 value: (plot, value) => (value === null ? '\u2013' : shortNumber(value)) };
    });
    const options = this.#options(190);
    options.scales.y = { range: valueRange };
    options.series = [{ label: 'time [s]', value: (plot, value) => (value === null ? '\u2013' : value.toFixed(2)) },
      ...series];
    options.axes = [axis('time [s]', 32), axis(`[${panel.unit}]`, 72)];
    return new uPlot(options, panel.data, box);
  }

  #drawBands(panel) {
    const box = this.#box(panel.title, '');
    const options = this.#options(48 + 34 * panel.rows.length);
    options.legend = { show: false };
    options.scales.y = { range: [0, panel.rows.length] };
    options.series = [{}, { show: false }];
    options.axes = [axis('time [s]', 32),
      { ...axis('', 72), labelSize: 0, size: 92, grid: { show: false }, ticks: { show: false },
      splits: panel.rows.map((row, i) => panel.rows.length - i - 0.5),
        values: () => panel.rows.map((row) => row.name) }];
    options.hooks.draw.unshift((plot) => this.#drawRows(plot, panel.rows));
    const plot = new uPlot(options, [[...this.range], [null, null]], box);
    const used = new Map();
    for (const row of panel.rows) for (const [, , state] of row.bands) used.set(row.text(state), row.color(state));
    box.append(element('p', { class: 'faint' },
      ...[...used].map(([text, color]) => element('span', { class: 'entry' }, swatch(color), text))));
    return plot;
  }

  #drawRows(plot, rows) {
    const { ctx } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
    ctx.clip();
    const row_px = plot.bbox.height / rows.length;
    rows.forEach((row, i) => {
      for (const [begin, end, state] of row.bands) {
        const left = plot.valToPos(begin, 'x', true);
        ctx.fillStyle = row.color(state);
        ctx.fillRect(left, plot.bbox.top + (i + 0.15) * row_px, Math.max(1, plot.valToPos(end, 'x', true) - left),
          0.7 * row_px);
      }
    });
    ctx.restore();
  }

  #drawMarks(plot) {
    const { ctx, bbox } = plot;
    const line = (time, color, dash, width) => {
      if (time < plot.scales.x.min || time > plot.scales.x.max) return;
      const x = Math.round(plot.valToPos(time, 'x', true));
      ctx.strokeStyle = color;
      ctx.lineWidth = width * devicePixelRatio;
      ctx.setLineDash(dash);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    };
    ctx.save();
    for (const time of this.events) line(time, styleColor('--faint'), [2, 3], 1);
    line(this.time, styleColor('--accent'), [], 2);
    ctx.restore();
  }

  /// A click, not the end of a drag.
  #followClicks(plot) {
    let down = null;
    plot.over.addEventListener('mousedown', (event) => { down = event.clientX; });
    plot.over.addEventListener('click', (event) => {
      if (down === null || Math.abs(event.clientX - down) > 3) return;
      this.onTime(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, 'x'));
    });
  }

  #box(title, unit) {
    const box = element('div', { class: 'curve', 'data-title': title },
      element('h3', {}, unit === '' ? title : `${title} [${unit}]`));
    this.parent.append(box);
    return box;
  }
}

export function swatch(color) {
  return element('span', { class: 'swatch', style: `background: ${color}` });
}

export const readFloats = floats;
export const readDoubles = doubles;
