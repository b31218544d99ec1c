// The page of one run.
import { Curves, readDoubles, readFloats, swatch } from './curves.js';
import { Heights, doubles, floats, words } from './data.js';
import { changeText, element, figure, plainNumber, seconds, select, shortNumber, table } from './elements.js';
import { TerrainView } from './terrain_view.js';

/// Columns of frames.csv that stand beside the slider; all of them are below.
const pose = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];

/// The rows of frames.csv at the slider's stops, of one robot.
class StopRows {
  static async load(stops, count) {
    const rows = new StopRows();
    rows.columns = stops.columns;
    rows.values = await doubles(stops.block);
    rows.count = count;
    rows.index = new Map(stops.columns.map((column, i) => [column.name, i]));
    return rows;
  }
  value(name, stop) {
    return this.values[this.index.get(name) * this.count + stop];
  }
}

function identity(facts) {
  return table(null, facts.identity.map(({ name, value }) =>
    ({ name, cells: [element('span', { class: 'faint' }, name), String(value)] })));
}

function figures(list, more = []) {
  const rows = list.map(({ name, unit, value }) =>
    ({ name, cells: [element('span', { class: 'faint' }, name), figure(value), unit] }));
  return table(null, [...rows,
    ...more.map(([name, text]) => ({ name, cells: [element('span', { class: 'faint' }, name), text, ''] }))]);
}

/// The same of several robots, a column each.
function figuresByRobot(robots, ends) {
  const name = (text) => element('span', { class: 'faint' }, text);
  const rows = robots[0].figures.map((it, i) =>
    ({ name: it.name, cells: [name(it.name), ...robots.map((robot) => figure(robot.figures[i].value)), it.unit] }));
  return table(['', ...robots.map((robot) => robot.name), ''],
    [...rows, ...ends.map(([title, key]) =>
      ({ name: title, cells: [name(title), ...robots.map((robot) => robot[key]), ''] }))]);
}

/// What the drive did to the ground, in a line; null where it moved none.
function levelText(terrain) {
  const of = (list, name) => list?.find((it) => it.name === name);
  if (!(of(terrain?.change, 'Ground moved')?.value > 0)) return null;
  const { unit, before, after } = of(terrain.figures, 'Height about level (rms)');
  return `Height about level: ${changeText(before, after, unit)}.`;
}

function header(page, facts) {
  page.append(element('h1', {}, facts.title));
  if (!facts.complete) page.append(
    element('p', { class: 'warning' }, facts.running ?
      'The run goes on: this is what was saved when this page was made.' :
      'The recorded run did not end: this is what was written until then.'));
  const level = levelText(facts.terrain);
  if (level !== null) page.append(element('p', { class: 'level' }, level));
  const { robots } = facts;
  const ends = [['State at the end', 'state'], ['Faults at the end', 'faults']];
  const of = robots.length > 1 ? figuresByRobot(robots, ends)
    : figures(robots[0].figures, ends.map(([name, key]) => [name, robots[0][key]]));
  page.append(element('div', { class: 'columns' }, identity(facts),
    element('div', {}, of, facts.terrain?.change ? figures(facts.terrain.change) : null)));
}

function legend(facts, view) {
  const { terrain } = facts;
  const bar = element('div', { class: 'bar' });
  const title = element('div', {});
  const ends = element('div', { class: 'ends' });
  const states = new Set();
  for (const robot of view.robots) for (const state of robot.track.states) states.add(state);
  const box = element('div', { class: 'legend' }, title, bar, ends,
    element('div', { style: 'margin-top: 6px' }, 'driven path, by leveling state'),
    ...[...states].sort((a, b) => a - b).map((state) =>
      element('div', {}, swatch(facts.leveling_states[state]?.color ?? '#888'),
        facts.leveling_states[state]?.name ?? `state ${state}`)));
  const show = (byChange) => {
    const colors = byChange ? terrain.change_colors : terrain.height_colors;
    bar.style.background = `linear-gradient(to right, ${colors.map((rgb) => `rgb(${rgb.join(' ')})`).join(', ')})`;
    title.textContent = byChange ? 'change since the start [mm]' : 'height [mm]';
    const range = byChange ? [-terrain.change_limit_m, 0, terrain.change_limit_m] : terrain.color_range_m;
    ends.replaceChildren(...range.map((value) => element('span', {}, plainNumber(1000 * value))));
  };
  show(false);
  return { box, show };
}

function terrainNotes(terrain, view) {
  const grid = terrain.merged > 1
    ? `Each height is the mean of ${terrain.merged} \u00d7 ${terrain.merged} heights of the run's grid `
      + `(${plainNumber(1000 * terrain.spacing_m)} mm).`
    : `The run's own grid of ${plainNumber(1000 * terrain.spacing_m)} mm.`;
  const notes = [`${grid} Heights are rounded to ${plainNumber(1000 * terrain.unit_m)} mm.`];
  if (terrain.filtered) notes.push(
    'The surface of a bed of particles is shown without single stones (low-pass of one particle radius).');
  if (!terrain.recorded) notes.push(
    'The heights of the ticks were not recorded (sim --heights, record): '
    + 'the terrain is that before the run until its end.');
  if (view === null) notes.push('This browser has no WebGL: there is no picture of the terrain.');
  return element('p', { class: 'faint' }, notes.join(' '));
}

/// What the slider moves. `show(stop)` is the one way to do so.
class Timeline {
  constructor(facts) {
    this.facts = facts;
    this.listeners = [];
    this.last = facts.stops.length - 1;
    this.input = element('input', { type: 'range', min: 0, max: this.last, value: 0, step: 1, 'aria-label': 'time' });
    this.output = element('output', {});
    this.play = element('button', { type: 'button' }, 'Play');
    this.input.addEventListener('input', () => this.show(Number(this.input.value)));
    this.play.addEventListener('click', () => (this.timer ? this.#stop() : this.#start()));
    this.element = element('div', { class: 'time' }, this.play, this.input, this.output);
  }
  timeOf(stop) {
    return (this.facts.stops[stop] + 1) * this.facts.tick_s;
  }
  show(stop) {
    this.stop = stop;
    this.input.value = stop;
    this.output.textContent = `${seconds(this.timeOf(stop))} of ${seconds(this.timeOf(this.last))}`;
    document.documentElement.dataset.stop = stop;
    for (const listener of this.listeners) listener(stop, this.facts.stops[stop], this.timeOf(stop));
  }
  showTime(time) {
    let stop = 0;
    while (stop < this.last && this.timeOf(stop + 1) <= time) ++stop;
    this.show(stop);
  }
  #start() {
    if (this.stop === this.last) this.show(0);
    this.play.textContent = 'Pause';
    const step = Math.max(1, Math.round(this.last / 300));
    this.timer = setInterval(() => {
      this.show(Math.min(this.last, this.stop + step));
      if (this.stop === this.last) this.#stop();
    }, 50);
  }
  #stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.play.textContent = 'Play';
  }
}

async function terrainSection(page, facts, timeline, rows) {
  const { terrain } = facts;
  page.append(element('h2', {}, 'Terrain and path'));
  const box = element('div', { class: 'view' });
  const controls = element('div', { class: 'controls' }, timeline.element);
  if (terrain === null) {
    page.append(element('p', { class: 'faint' }, 'The session holds no terrain.'), controls);
    return;
  }
  page.append(box, controls);
  const heights = await Heights.load(terrain);
  const tracks = await Promise.all(facts.robots.map(async ({ track }) => ({
    rows: await words(`${track.block}-rows`), places: await floats(`${track.block}-places`),
      states: await words(`${track.block}-states`) })));
  let view = null;
  try {
    view = new TerrainView(box, facts, heights, tracks);
  } catch (error) {
    box.remove();
  }
  if (view !== null) {
    const shown = legend(facts, view);
    box.append(shown.box);
    let moment = 'time';
    const steps = (stop) => {
      if (moment !== 'time') return moment === 'before' ? 0 : heights.steps.length;
      return terrain.step_stops.filter((it) => it <= stop).length;
    };
    const show = (stop, row) => {
      const changed = heights.go(steps(stop));
      view.update(row, rows.map((it) => Object.fromEntries(pose.map((name) => [name, it.value(name, stop)]))), changed);
    };
    timeline.listeners.push(show);
    const reset = element('button', { type: 'button' }, 'Oblique view');
    const above = element('button', { type: 'button' }, 'View from above');
    reset.addEventListener('click', () => view.resetCamera());
    above.addEventListener('click', () => view.resetCamera(true));
    controls.append(
      select('Terrain', [['time', 'at the slider\u2019s time'], ['before', 'before the run'],
        ['after', 'after the run']], (value) => {
        moment = value;
        timeline.show(timeline.stop);
      }),
      select('Colours', [['height', 'height'], ['change', 'change since the start']], (value) => {
        view.setByChange(value === 'change');
        shown.show(value === 'change');
      }),
      select('Path', [['recent', 'recent'], ['whole', 'whole']],
        (value) => view.setWholePath(value === 'whole')),
      select('Heights', [1, 2, 5, 10].map((times) => [times, `${times} \u00d7`]),
        (value) => view.setExaggeration(Number(value))),
      reset, above);
  }
  page.append(terrainNotes(terrain, view));
}

/// The row of frames.csv at the slider's time, in numbers.
function rowSection(page, facts, timeline, rows) {
  rows.forEach((it, robot) => {
    const title = facts.robots.length > 1 ? `, ${facts.robots[robot].name}` : '';
    const cells = it.columns.map(() => element('td', { class: 'number' }));
    const body = it.columns.map((column, i) =>
      element('tr', { 'data-column': column.name }, element('td', {}, column.name), cells[i],
      element('td', {}, column.unit), element('td', { class: 'faint' }, column.meaning)));
    const row = element('span', {});
    page.append(element('details', { class: 'row' },
      element('summary', {}, `All figures at the slider\u2019s time${title}`),
      element('p', { class: 'faint' }, 'Row ', row, ' of frames.csv (screed session export --csv --all), rows from 0.'),
      element('div', { class: 'scroll' }, element('table', {}, element('tbody', {}, ...body)))));
    timeline.listeners.push((stop, number) => {
      row.textContent = number;
      it.columns.forEach((column, i) => {
        const value = it.value(column.name, stop);
        cells[i].textContent = Number.isInteger(value) ? String(value) : shortNumber(value);
        cells[i].dataset.value = value;
      });
    });
  });
}

async function curveSection(page, facts, timeline) {
  page.append(element('h2', {}, 'Curves'),
    element('p', { class: 'faint' },
      'Drag to zoom, double-click to see all, click to move the slider. '
      + 'The blue line is the slider\u2019s time, dotted lines are events, '
      + 'dashed curves are estimates of the firmware.'));
  for (const robot of facts.robots) {
    if (facts.robots.length > 1) page.append(element('h3', {}, robot.name));
    if (robot.bucket_ticks > 1) {
      page.append(element('p', { class: 'faint' },
        `Of each ${robot.bucket_ticks} ticks (${plainNumber(robot.bucket_ticks * facts.tick_s)} s) `
        + 'the lowest and the highest value is drawn.'));
    }
    const box = element('div', {});
    page.append(box);
    const curves = new Curves(box, robot.events.map((event) => event.time_s), (time) => timeline.showTime(time));
    curves.addBands('States', [
      { name: 'leveling', bands: robot.leveling, color: (state) => facts.leveling_states[state]?.color ?? '#888',
        text: (state) => facts.leveling_states[state]?.name ?? `state ${state}` },
    ]);
    await curves.add(robot.panels, readFloats);
    if (robot === facts.robots[0] && facts.terrain !== null) await curves.add(facts.terrain.curves, readDoubles,
      !facts.terrain.recorded);
    curves.draw();
    timeline.listeners.push((stop, row, time) => curves.setTime(time));
  }
}

function eventSection(page, facts, timeline) {
  page.append(element('h2', {}, 'Events'));
  for (const robot of facts.robots) {
    const rows = robot.events.map((event) => {
      const button = element('button', { type: 'button' }, seconds(event.time_s));
      button.addEventListener('click', () => timeline.showTime(event.time_s));
      return { cells: [button, event.text] };
    });
    page.append(rows.length > 0
      ? table(['time', facts.robots.length > 1 ? robot.name : 'supervisor state or fault'], rows)
      : element('p', {}, 'None.'));
  }
}

function terrainFigures(page, facts) {
  if (!facts.terrain?.figures) return;
  page.append(element('h2', {}, 'Terrain before and after'),
    table(['', 'before', 'after', 'unit'],
      facts.terrain.figures.map(({ name, unit, before, after }) =>
        ({ name, cells: [name, figure(before), figure(after), unit] }))),
    element('p', { class: 'faint' }, `A cell is flat up to ${facts.terrain.flat_deg}\u00b0.`));
}

function configurationSection(page, facts) {
  page.append(element('h2', {}, 'Configuration'));
  const sections = new Map();
  for (const { section, key, value } of facts.configuration) {
    if (!sections.has(section)) sections.set(section, []);
    sections.get(section).push({ cells: [key, value] });
  }
  page.append(element('div', { class: 'columns' },
    ...[...sections].map(([section, rows]) =>
      element('div', {}, element('h3', {}, `[${section}]`), table(null, rows)))));
  const changed = facts.parameters.filter((it) => it.value !== it.default).length;
  page.append(element('h2', {}, 'Parameters of the firmware'),
    element('p', { class: 'faint' }, `${changed} of ${facts.parameters.length} differ from their defaults (bold).`),
    element('details', {}, element('summary', {}, 'All parameters'),
      table(['name', 'value', 'default', 'unit', 'meaning'], facts.parameters.map((it) => ({
        class: it.value !== it.default ? 'changed' : undefined, name: it.name,
        cells: [it.name, it.recorded ? { number: it.value, text: String(it.value) } : 'not recorded',
          { number: it.default, text: String(it.default) }, it.unit, it.meaning] })))));
}

export async function showRun(page, facts) {
  header(page, facts);
  const rows = await Promise.all(facts.robots.map((robot) => StopRows.load(robot.stops, facts.stops.length)));
  const timeline = new Timeline(facts);
  await terrainSection(page, facts, timeline, rows);
  rowSection(page, facts, timeline, rows);
  await curveSection(page, facts, timeline);
  eventSection(page, facts, timeline);
  terrainFigures(page, facts);
  configurationSection(page, facts);
  timeline.show(timeline.last);
}
