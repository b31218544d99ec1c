// Elements of the page, short to write.

/// element('td', { class: 'number' }, 'text', child, ...)
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(key, '');
    else if (value !== false && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

/// A labelled choice. `options`: [value, text]; `chosen`: the value at the start, the first one without.
export function select(label, options, onChange, chosen) {
  const made = element('select', { 'aria-label': label },
    ...options.map(([value, text]) => element('option', { value, selected: value === chosen }, text)));
  made.addEventListener('change', () => onChange(made.value));
  return element('label', {}, label, made);
}

/// Rows of cells; a cell is text, an element, or { number, text } for a figure, which keeps all its digits in
/// data-value.
export function table(head, rows) {
  const cell = (kind, content) => {
    if (content !== null && typeof content === 'object' && 'number' in content) {
      return element(kind, { class: 'number', 'data-value': content.number }, content.text);
    }
    return element(kind, {}, content ?? '');
  };
  const numeric = (column) =>
    rows.some((row) => row.cells[column] !== null && typeof row.cells[column] === 'object' &&
      'number' in row.cells[column]);
  const parts = [];
  if (head !== null) {
    parts.push(element('thead', {},
      element('tr', {}, ...head.map((text, i) => element('th', { class: numeric(i) ? 'number' : undefined }, text)))));
  }
  parts.push(element('tbody', {},
    ...rows.map((row) =>
      element('tr', { class: row.class, 'data-name': row.name }, ...row.cells.map((content) => cell('td', content))))));
  return element('div', { class: 'scroll' }, element('table', {}, ...parts));
}

/// A number with some four digits; all of them stay in `number`.
export function figure(number) {
  return { number, text: shortNumber(number) };
}

export function shortNumber(number) {
  if (!Number.isFinite(number)) return '\u2013';
  if (number === 0) return '0';
  if (Math.abs(number) < 1e-3) return number.toExponential(2).replaceAll('-', '\u2212');
  const digits = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(Math.abs(number)))));
  return number.toFixed(digits).replace('-', '\u2212');
}

/// The same without zeros at its end, for running text.
export const plainNumber = (number) =>
  (number === 0 ? '0' : String(Number(number.toPrecision(4))).replace('-', '\u2212'));

/// The ticks of an axis as text: all with the decimals that tell each from the next, zero without a sign.
export function tickTexts(marks) {
  const known = marks.filter(Number.isFinite);
  const step = known.length > 1 ? Math.abs(known[1] - known[0]) : Math.abs(known[0] ?? 0);
  let decimals = 0;
  while (decimals < 12 && step > 0 && Math.abs(step - Number(step.toFixed(decimals))) > 1e-3 * step) ++decimals;
  return marks.map((mark) => {
    if (!Number.isFinite(mark)) return '';
    const [whole, fraction] = Math.abs(mark).toFixed(decimals).split('.');
    const text = whole.replace(/\B(?=(\d{3})+$)/g, '\u2009') + (fraction === undefined ? '' : `.${fraction}`);
    return mark < 0 && Number(mark.toFixed(decimals)) !== 0 ? `\u2212${text}` : text;
  });
}

/// "10.9 \u2192 4.6 mm (\u221258 %)"; from 0 there is no change in per cent.
export function changeText(before, after, unit) {
  const percent = Math.round(100 * (after / before - 1));
  const change = Number.isFinite(percent) ? ` (${percent > 0 ? '+' : ''}${tickTexts([percent])[0]} %)` : '';
  return `${before.toFixed(1)} \u2192 ${after.toFixed(1)} ${unit}${change}`;
}

export const seconds = (time) => `${time.toFixed(2)} s`;

/// A colour of the style sheet.
export const styleColor = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// Calls back when the reader's system changes between light and dark.
export function onSchemeChange(callback) {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', callback);
}
