// Means of a campaign's cells over time, each with the band of its interval.
import uPlot from 'uplot';
import { axis, valueRange } from './curves.js';
import { element, figure, onSchemeChange, select, shortNumber, styleColor, table } from './elements.js';

/// Columns of the table below the plot: shares of the time.
const shares = [0.25, 0.5, 0.75, 1];

/// As many colours as there are cells, in their order, opaque or for a band.
function colorOf(cell, cells, band) {
  if (cells <= 4) return styleColor(`--series-${cell + 1}`) + (band ? '29' : '');
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  return `hsl(${(210 + (360 * cell) / cells) % 360} 65% ${dark ? 62 : 42}% / ${band ? 0.16 : 1})`;
}

/// Three series a cell: the mean, and both ends of its band, which are not drawn.
function plotOf(box, curve, names) {
  const count = curve.cells.length;
  const series = [{ label: 'time [s]', value: (plot, value) => (value === null ? '\u2013' : value.toFixed(1)) }];
  const bands = [];
  curve.cells.forEach((cell, i) => {
    const edge = { label: `${names[i]}, interval`, class: 'band', width: 0, stroke: 'transparent',
      points: { show: false } };
    series.push({ label: names[i], stroke: colorOf(i, count, false), width: 2, points: { show: false },
      value: (plot, value) => (value === null ? '\u2013' : shortNumber(value)) }, edge, edge);
    bands.push({ series: [3 * i + 3, 3 * i + 2], fill: colorOf(i, count, true) });
  });
  const width = () => Math.max(280, box.clientWidth - 20);
  const plot = new uPlot(
    { width: width(), height: 320, series, bands, scales: { x: { time: false }, y: { range: valueRange } },
      cursor: { drag: { x: true, y: false }, y: false },
      axes: [axis('time [s]', 32), axis(`${curve.name.replaceAll('_', ' ')} [${curve.unit}]`, 72)] },
    [curve.times, ...curve.cells.flatMap((cell) => [cell.mean, cell.low, cell.high])], box);
  new ResizeObserver(() => plot.setSize({ width: width(), height: 320 })).observe(box);
}

function tableOf(curve, facts) {
  const end = curve.times[curve.times.length - 1];
  const places = shares.map((share) =>
    curve.times.findLastIndex((time) => time <= share * end + 1e-9)).filter((place) => place >= 0);
  const interval = (cell, place) =>
    (cell.low[place] === null ? null
      : element('span', { class: 'interval', 'data-low': cell.low[place], 'data-high': cell.high[place] },
        `${shortNumber(cell.low[place])} to ${shortNumber(cell.high[place])}`));
  return table([...facts.factors, ...places.flatMap((place) => [`${curve.times[place].toFixed(0)} s`, '95 %'])],
    facts.cells.map(({ values }, i) =>
      ({ name: `curve of cell ${i}`,
        cells: [...values, ...places.flatMap((place) =>
          [figure(curve.cells[i].mean[place] ?? NaN), interval(curve.cells[i], place)])] })));
}

/// `names`: of the cells.
export function curveSection(page, facts, names) {
  page.append(element('h2', {}, 'Over time'));
  if (facts.curves.length === 0) {
    page.append(element('p', { class: 'faint' }, facts.curves_note));
    return;
  }
  const box = element('div', {});
  let shown = facts.curves[0];
  const show = (curve) => {
    shown = curve;
    const plot = element('div', { class: 'curve' });
    box.dataset.curve = curve.name;
    box.replaceChildren(plot, tableOf(curve, facts));
    plotOf(plot, curve, names);
  };
  page.append(element('div', { class: 'controls' },
    select('Curve', facts.curves.map((curve, i) => [i, curve.name.replaceAll('_', ' ')]),
      (value) => show(facts.curves[Number(value)]))),
    element('p', { class: 'faint' },
      'Means over the seeds; the bands are their intervals (bootstrap, BCa, 95 %). '
      + 'A run that ended before keeps its last value: its ground stays as it was left.'), box);
  show(shown);
  onSchemeChange(() => show(shown));
}
