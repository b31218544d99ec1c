// The page of a campaign: one metric at a time, over cells, levels of factors and seeds; how the runs ended; the runs.
import { curveSection } from './cell_curves.js';
import { doubles } from './data.js';
import { element, figure, select, shortNumber, table } from './elements.js';
import { forestPlot, scatterPlot } from './forest_plot.js';

/// More levels than that, all of them numbers, are a range.
const maxLevels = 12;
/// Rows of the table of runs.
const maxRuns = 2000;

const chance = (number) => ({ number, text: number < 0.001 ? '< 0.001' : number.toFixed(3) });
const whole = (number) => ({ number, text: String(number) });
const between = ({ low, high }, text) =>
  element('span', { class: 'interval', 'data-low': low, 'data-high': high }, `${text(low)} to ${text(high)}`);
/// A mean and its interval as two cells of a table.
const spread = (value) =>
  (value === null ? [null, null] : [figure(value.mean), value.low === null ? null : between(value, shortNumber)]);
const cellName = (facts, cell) => facts.cells[cell].values.join(', ') || 'the experiment';
const drawn = (value) => value && { ...value, low: value.low ?? NaN, high: value.high ?? NaN };

function header(page, facts) {
  page.append(element('h1', {}, facts.title));
  const { runs, done, failed } = facts.counts;
  if (done + failed < runs) page.append(
    element('p', { class: 'warning' },
      `Incomplete: ${runs - done - failed} of ${runs} runs have not been made. No figure here is a result.`));
  if (failed > 0) page.append(
    element('p', { class: 'warning' },
      `${failed} of ${runs} runs failed (they crashed or passed their limit): they have no values. See below.`));
  page.append(table(null,
    facts.identity.map(({ name, value }) => ({ name, cells: [element('span', { class: 'faint' }, name), value] }))));
}

function cellTable(facts, metric) {
  const rows = facts.cells.map((cell, i) => {
    const { value, difference, rank } = metric.cells[i];
    return { name: `cell ${i}`, class: i === facts.baseline ? 'changed' : undefined,
             cells: [...cell.values, whole(value.count), ...spread(value),
                     ...(difference === null ? [null, null, null, null]
                       : [...spread(difference), chance(difference.p_holm), figure(difference.effect)]),
                     ...spread(rank)] };
  });
  return table([...facts.factors, 'seeds', 'mean', '95 %', 'difference', '95 %', 'p', 'effect', 'rank', '95 %'], rows);
}

function cellPlot(parent, facts, metric, values) {
  const seeds = facts.seeds.length;
  forestPlot(parent, facts.cells.map((cell, i) => cellName(facts, i)), [
    { title: 'mean', label: metric.name, zero: false,
      values: metric.cells.map((cell, i) =>
        ({ ...drawn(cell.value), all: Array.from(values.subarray(i * seeds, (i + 1) * seeds)) })) },
    { title: 'less the baseline', label: metric.name, zero: true,
      values: metric.cells.map((cell) => drawn(cell.difference)) },
    { title: 'mean rank', label: 'rank, 1 is the lowest value', zero: false,
      values: metric.cells.map((cell) => drawn(cell.rank)) },
  ]);
}

/// Numbers of a factor by run, or null where its levels are few or words.
function numbersOf(facts, factor) {
  const values = facts.cells.map((cell) => (cell.values[factor].trim() === '' ? NaN : Number(cell.values[factor])));
  return new Set(values).size > maxLevels && values.every(Number.isFinite) ? values : null;
}

function factorSection(parent, facts, metric, values) {
  facts.factors.forEach((name, factor) => {
    const box = element('div', { class: 'curve', 'data-factor': name }, element('h3', {}, name));
    parent.append(box);
    const numbers = numbersOf(facts, factor);
    const seeds = facts.seeds.length;
    if (numbers !== null) {
      const points = [...values].map((value, run) => [numbers[Math.floor(run / seeds)], value]).filter((point) =>
        Number.isFinite(point[1]));
      scatterPlot(box, points, name, metric.name);
      return;
    }
    const levels = metric.levels[factor];
    box.append(table([name, 'cells', 'seeds', 'mean', '95 %'],
      levels.map((level) =>
        ({ name: level.value, cells: [level.value, whole(level.cells), whole(level.count), ...spread(level)] }))));
    forestPlot(box, levels.map((level) => level.value),
      [{ title: 'mean over the other factors', label: metric.name, zero: false, values: levels.map(drawn) }]);
  });
}

async function metricSection(page, facts) {
  const box = element('div', {});
  const note = `Means over the seeds; intervals by the bootstrap (BCa, 95 %). Differences are taken seed by seed `
    + `from the baseline (bold), ${facts.cells[facts.baseline].values.join(', ') || 'the only cell'}; `
    + 'p is of Wilcoxon\u2019s signed-rank test, two-sided, adjusted for the number of cells after Holm; '
    + 'the effect is the rank-biserial correlation of the pairs, from \u22121 to 1. '
    + 'Ranks are those of the cells within a seed. '
    + 'The levels of a factor are averaged over the other factors, seed by seed.';
  const show = async (index) => {
    const metric = facts.metrics[index];
    const values = await doubles(metric.block);
    box.replaceChildren();
    box.dataset.metric = metric.name;
    const plot = element('div', { class: 'curve' });
    box.append(plot, cellTable(facts, metric));
    cellPlot(plot, facts, metric, values);
    // Of one factor with few levels the cells say it all.
    if (facts.factors.length > 1 || facts.factors.some((name, factor) => numbersOf(facts, factor) !== null)) {
      box.append(element('h2', {}, 'Factors'));
      factorSection(box, facts, metric, values);
    }
  };
  page.append(element('h2', {}, 'Metric'),
    element('div', { class: 'controls' },
      select('Metric', facts.metrics.map((metric, i) => [i, metric.name]), (value) => show(Number(value)),
        facts.metric)),
    element('p', { class: 'faint' }, note), box);
  if (facts.metrics.length > 0) await show(facts.metric);
}

function outcomeSection(page, facts) {
  page.append(element('h2', {}, 'How the runs ended'));
  const rows = facts.cells.map((cell, i) => ({ name: `ends of cell ${i}`, cells: [...cell.values,
    ...cell.outcomes.flatMap((it) => [whole(it.count), between(it, (number) => `${(100 * number).toFixed(0)} %`)])] }));
  page.append(table([...facts.factors, ...facts.outcomes.flatMap((name) => [name, '95 %'])], rows),
    element('p', { class: 'faint' },
      'Runs, and the share of the cell\u2019s runs between which the true one lies (Wilson). None is left out.'));
  if (facts.failures.length === 0) return;
  page.append(element('h3', {}, 'Failed runs'),
    table(['run', ...facts.factors, 'seed', 'why'],
      facts.failures.map((it) =>
        ({ class: 'failure', cells: [whole(it.run), ...facts.cells[it.cell].values, it.seed, it.why] }))));
}

function runSection(page, facts) {
  const seeds = facts.seeds.length;
  const shown = facts.runs.slice(0, maxRuns);
  const rows = shown.map(({ outcome, link }, run) => {
    const cell = Math.floor(run / seeds);
    return { cells: [link === undefined ? String(run) : element('a', { href: link }, String(run)),
      ...facts.cells[cell].values, facts.seeds[run % seeds], outcome === null ? 'not made' : facts.outcomes[outcome]] };
  });
  page.append(element('h2', {}, 'Runs'), element('p', { class: 'faint' }, facts.runs_note),
    element('details', { class: 'runs' },
      element('summary', {}, shown.length < facts.runs.length ? `The first ${maxRuns} of ${facts.runs.length} runs`
        : `All ${facts.runs.length} runs`),
      table(['run', ...facts.factors, 'seed', 'end'], rows)));
}

export async function showCampaign(page, facts) {
  header(page, facts);
  await metricSection(page, facts);
  curveSection(page, facts, facts.cells.map((cell, i) => cellName(facts, i)));
  outcomeSection(page, facts);
  runSection(page, facts);
}
