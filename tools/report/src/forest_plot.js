// Rows with a name, and beside each its figures as points with intervals, in columns of one axis each. SVG, coloured by
// the style sheet.
import { tickTexts } from './elements.js';

const rowHeight = 24;
const axisHeight = 44;
const headHeight = 22;
const gap = 28;
const letter = 7.5;
const maxName = 330;

function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/// Round numbers from low to high, some `count` of them.
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const marks = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; ++i) marks.push(i * step);
  return marks;
}

/// From the lowest to the highest of the numbers, a little more on both sides.
function rangeOf(numbers, zero) {
  const known = numbers.filter(Number.isFinite);
  if (zero) known.push(0);
  if (known.length === 0) return [0, 1];
  const low = Math.min(...known);
  const high = Math.max(...known);
  const margin = high > low ? 0.06 * (high - low) : Math.max(1e-9, 0.1 * Math.abs(high));
  return [low - margin, high + margin];
}

function axis(group, scale, range, top, bottom, width, title, label) {
  const marks = ticks(...range, Math.max(2, width / 90));
  const texts = tickTexts(marks);
  marks.forEach((mark, i) => {
    const x = scale(mark);
    group.append(svg('line', { x1: x, x2: x, y1: top, y2: bottom, class: 'grid' }),
      svg('text', { x, y: bottom + 16, class: 'tick' }, texts[i]));
  });
  group.append(svg('text', { x: scale(range[0]), y: 14, class: 'title' }, title),
    svg('text', { x: (scale(range[0]) + scale(range[1])) / 2, y: bottom + 36, class: 'tick' }, label));
}

/// `rows`: names. `columns`: [{ title, label, zero, values: [{ mean, low, high, all }] }]: `all` are single values
/// behind the mean, `zero` draws that line. A value may be null.
export function forestPlot(parent, rows, columns) {
  const width = Math.max(600, parent.clientWidth - 20);
  const names = Math.min(maxName, 30 + letter * Math.max(...rows.map((row) => row.length)));
  const columnWidth = (width - names) / columns.length - gap;
  const top = headHeight;
  const bottom = top + rows.length * rowHeight;
  const root = svg('svg',
    { class: 'forest', width, height: bottom + axisHeight, role: 'img',
      'aria-label': columns.map((column) => column.title).join(', ') });
  rows.forEach((row, i) => {
    const y = top + (i + 0.5) * rowHeight;
    root.append(svg('line', { x1: 0, x2: width, y1: y + rowHeight / 2, y2: y + rowHeight / 2, class: 'row' }));
    const room = Math.floor((names - 16) / letter);
    const shown = row.length > room ? `${row.slice(0, room - 1)}\u2026` : row;
    root.append(svg('text', { x: 0, y: y + 5, class: 'name' }, svg('title', {}, row), shown));
  });
  columns.forEach((column, i) => {
    const left = names + i * (columnWidth + gap);
    const values = column.values.filter((value) => value !== null);
    const range = rangeOf(values.flatMap((value) => [value.low, value.high, value.mean, ...(value.all ?? [])]),
      column.zero);
    const scale = (number) => left + ((number - range[0]) / (range[1] - range[0])) * columnWidth;
    const group = svg('g', { 'data-column': column.title });
    axis(group, scale, range, top, bottom, columnWidth, column.title, column.label);
    if (column.zero) group.append(svg('line', { x1: scale(0), x2: scale(0), y1: top, y2: bottom, class: 'zero' }));
    column.values.forEach((value, row) => {
      if (value === null || !Number.isFinite(value.mean)) return;
      const y = top + (row + 0.5) * rowHeight;
      for (const single of value.all ?? []) {
        if (Number.isFinite(single)) group.append(svg('circle', { cx: scale(single), cy: y, r: 2.5, class: 'single' }));
      }
      if (Number.isFinite(value.low)) group.append(
        svg('line', { x1: scale(value.low), x2: scale(value.high), y1: y, y2: y, class: 'interval' }));
      group.append(svg('circle', { cx: scale(value.mean), cy: y, r: 4.5, class: 'mean', 'data-row': row }));
    });
    root.append(group);
  });
  parent.append(root);
}

/// Single values over a number: a cloud of points.
export function scatterPlot(parent, points, xLabel, yLabel) {
  const width = Math.max(300, Math.min(760, parent.clientWidth - 20));
  const height = 300;
  const box = { left: 74, right: width - 14, top: 12, bottom: height - 48 };
  const ranges = [rangeOf(points.map((point) => point[0]), false), rangeOf(points.map((point) => point[1]), false)];
  const x = (number) => box.left + ((number - ranges[0][0]) / (ranges[0][1] - ranges[0][0])) * (box.right - box.left);
  const y = (number) => box.bottom - ((number - ranges[1][0]) / (ranges[1][1] - ranges[1][0])) * (box.bottom - box.top);
  const root = svg('svg', { class: 'forest', width, height, role: 'img', 'aria-label': `${yLabel} over ${xLabel}` });
  const across = ticks(...ranges[0], width / 110);
  const acrossTexts = tickTexts(across);
  across.forEach((mark, i) => {
    root.append(svg('line', { x1: x(mark), x2: x(mark), y1: box.top, y2: box.bottom, class: 'grid' }),
      svg('text', { x: x(mark), y: box.bottom + 16, class: 'tick' }, acrossTexts[i]));
  });
  const upright = ticks(...ranges[1], 5);
  const uprightTexts = tickTexts(upright);
  upright.forEach((mark, i) => {
    root.append(svg('line', { x1: box.left, x2: box.right, y1: y(mark), y2: y(mark), class: 'grid' }),
      svg('text', { x: box.left - 6, y: y(mark) + 4, class: 'tick end' }, uprightTexts[i]));
  });
  for (const [px, py] of points) root.append(svg('circle', { cx: x(px), cy: y(py), r: 3, class: 'single' }));
  root.append(svg('text', { x: (box.left + box.right) / 2, y: height - 10, class: 'tick' }, xLabel));
  parent.append(root);
}
