// report_test.mjs PROGRAM FOLDER: pages of runs in a headless browser, against the CSV and the summary of the same
// runs.
//
// Ends with "N passed, N failed". FOLDER is for the runs; it is empty.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openReport, startBrowser, waitFor } from './browser.mjs';
import { mcapTests } from './mcap_tests.mjs';

const [program, folder] = process.argv.slice(2);
const key = '00112233445566778899aabbccddeeff';
const soil = `[experiment]
duration = 40
algorithm = spin_on_peak
seed = 3
[map]
size = 2
edges = walls
model = scm
[relief]
rms = 0.008
longest_wave = 1.5
shortest_wave = 0.3
[soil]
cell = 0.01
`;

const screed = (...words) =>
  execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

function record(name, text, ...options) {
  writeFileSync(join(folder, `${name}.ini`), text);
  screed('sim', `${name}.ini`, '--quiet', '--out', name, ...options);
  screed('report', name, '--quiet', '--out', `${name}.html`);
  return join(folder, `${name}.html`);
}

/// frames.csv as columns of numbers.
function readCsv(name) {
  screed('session', 'export', name, '--csv', '--all', '--out', `${name}_export`);
  const [head, ...lines] = readFileSync(join(folder, `${name}_export`, 'frames.csv'), 'utf8').trimEnd().split('\n');
  const rows = lines.map((line) => line.split(','));
  return new Map(head.split(',').map((title, i) => [title.replace(/ \[.*\]$/, ''), rows.map((row) => Number(row[i]))]));
}

const moveSlider = (page, stop) =>
  page.$eval('input[type=range]', (input, value) => {
    input.value = value;
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, stop);
const lastStop = (page) => page.$eval('input[type=range]', (input) => Number(input.max));
const shownRow = (page) =>
  page.$$eval('details.row tr[data-column]',
    (rows) => Object.fromEntries(rows.map((row) => [row.dataset.column, row.children[1].dataset.value])));
const figure = (page, name) =>
  page.$eval(`tr[data-name="${name}"] td[data-value]`, (cell) => Number(cell.dataset.value));
const canvas = async (page) => (await page.$('.view canvas')).screenshot({ encoding: 'base64' });
/// The numbers of a block as the page unpacks them.
const block = (page, name, type) =>
  page.evaluate(async (id, kind) => {
    const packed = Uint8Array.from(atob(document.getElementById(`block-${id}`).textContent), (c) => c.charCodeAt(0));
    const bytes = await new Response(
      new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();
    return Array.from(kind === 'float' ? new Float32Array(bytes) : new Float64Array(bytes));
  }, name, type);
const facts = (page) => page.$eval('#facts', (script) => JSON.parse(script.textContent));

/// Each curve that is a column: every tick of a short run, of a long one the extremes of each bucket.
async function curvesAreTheCsv(page, csv) {
  const robot = (await facts(page)).robots[0];
  let curves = 0;
  for (const panel of robot.panels) {
    for (const series of panel.series) {
      const shown = await block(page, series.block, 'float');
      const column = csv.get(series.column).map((value) => Math.fround(value * series.factor));
      if (robot.bucket_ticks === 1) assert.deepEqual(shown, column, series.column);
      for (let first = 0, at = 0; robot.bucket_ticks > 1 && first < column.length;
        first += robot.bucket_ticks, at += 2) {
        const bucket = column.slice(first, first + robot.bucket_ticks);
        assert.deepEqual([Math.min(shown[at], shown[at + 1]), Math.max(shown[at], shown[at + 1])],
          [Math.min(...bucket), Math.max(...bucket)], `${series.column} from row ${first}`);
      }
      ++curves;
    }
  }
  assert.ok(curves >= 15, `${curves} curves`);
}

const tests = {
  async 'of a run on soil: no complaint, the slider moves robot and terrain, light and dark differ'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'soil.html'));
    assert.equal(await page.$eval('.time output', (it) => it.textContent), '40.00 s of 40.00 s', 'opens at the end');
    const end = await canvas(page);
    await moveSlider(page, 0);
    const start = await canvas(page);
    assert.notEqual(end, start, 'the picture does not change with the slider');
    await moveSlider(page, await lastStop(page));
    assert.equal(await canvas(page), end);
    // With the robot where it is, only the ground differs.
    await page.select('select[aria-label=Terrain]', 'before');
    assert.notEqual(await canvas(page), end, 'the terrain before looks like that after');
    await page.select('select[aria-label=Terrain]', 'time');
    assert.equal(await canvas(page), end, 'going back and forth changes the terrain');
    await page.select('select[aria-label=Colours]', 'change');
    assert.match(await page.$eval('.legend', (it) => it.textContent), /change since the start \[mm\]/);
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }]);
    assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), 'rgb(20, 24, 27)');
    assert.deepEqual(complaints, []);
    await page.close();
  },
  async 'each stop of the slider shows a row of frames.csv, to the last bit'(browser) {
    const { page } = await openReport(browser, join(folder, 'soil.html'));
    const csv = readCsv('soil');
    const { stops } = await facts(page);
    assert.equal(stops.at(-1), csv.get('time').length - 1);
    for (const stop of [0, 1, Math.floor(stops.length / 3), stops.length - 1]) {
      await moveSlider(page, stop);
      const row = await shownRow(page);
      assert.deepEqual(['frame', ...Object.keys(row)], [...csv.keys()]);
      row.frame = stops[stop];
      for (const [name, column] of csv) assert.equal(Number(row[name]), column[stops[stop]],
        `${name} in row ${stops[stop]}`);
    }
    await page.close();
  },
  async 'curves are the columns of frames.csv'(browser) {
    for (const name of ['soil', 'rigid']) {
      const { page } = await openReport(browser, join(folder, `${name}.html`));
      await curvesAreTheCsv(page, readCsv(name));
      await page.close();
    }
  },
  async 'figures are those of the summary'(browser) {
    const { page } = await openReport(browser, join(folder, 'soil.html'));
    const summary = JSON.parse(readFileSync(join(folder, 'soil', 'summary.json'), 'utf8'));
    const near = (got, wanted, name) =>
      assert.ok(Math.abs(got - wanted) <= 1e-9 * Math.abs(wanted), `${name}: ${got}, not ${wanted}`);
    near(await figure(page, 'Energy drawn'), summary.energy_j, 'energy');
    near(await figure(page, 'Battery at the end'), summary.battery_v, 'battery');
    near(await figure(page, 'Ground moved'), 1000 * summary.terrain_change.moved_m3, 'moved');
    near(await figure(page, 'Deepest cut'), 1000 * summary.terrain_change.deepest_cut_m, 'cut');
    const rows = await page.$$eval('tr[data-name]',
      (all) => all.map((row) =>
        [row.dataset.name, ...[...row.querySelectorAll('td[data-value]')].map((cell) => Number(cell.dataset.value))]));
    for (const [name, key_, factor] of [['Height deviation (standard)', 'height_deviation_m', 1000],
      ['Height about level (rms)', 'level_deviation_m', 1000],
      ['Relief at robot scale (rms)', 'relief_m', 1000], ['Flat cells', 'flatness', 100]]) {
      const [, before, after] = rows.find((row) => row[0] === name);
      near(before, factor * summary.terrain_before[key_], `${name} before`);
      near(after, factor * summary.terrain_after[key_], `${name} after`);
    }
    const { level_deviation_m: before } = summary.terrain_before;
    const { level_deviation_m: after } = summary.terrain_after;
    const { changeText } = await import(pathToFileURL('tools/report/src/elements.js'));
    assert.equal(await page.$eval('.level', (it) => it.textContent),
      `Height about level: ${changeText(1000 * before, 1000 * after, 'mm')}.`);
    assert.equal(changeText(10.94, 4.6, 'mm'), '10.9 \u2192 4.6 mm (\u221258 %)');
    assert.equal(changeText(2, 2.5, 'mm'), '2.0 \u2192 2.5 mm (+25 %)');
    assert.equal(changeText(0, 1, 'mm'), '0.0 \u2192 1.0 mm');
    const identity = await page.$eval('#page', (it) => it.textContent);
    assert.ok(identity.includes(summary.content_hash) && identity.includes(summary.version));
    // The last point of the terrain's curve is the terrain at the end.
    near((await block(page, 'terrain-level', 'double')).at(-1), 1000 * summary.terrain_after.level_deviation_m,
      'last of the curve');
    await page.close();
  },
  async 'a run without recorded heights says so and moves its robot'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'rigid.html'), { scheme: 'dark' });
    assert.match(await page.$eval('#page', (it) => it.textContent), /heights of the ticks were not recorded/);
    const end = await canvas(page);
    await moveSlider(page, 0);
    assert.notEqual(await canvas(page), end);
    assert.equal(await page.$('.level'), null, 'the ground is rigid');
    assert.deepEqual(complaints, []);
    await page.close();
  },
  async 'of several robots each has its figures, its row at the slider and its path'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'several.html'));
    const summary = JSON.parse(readFileSync(join(folder, 'several', 'summary.json'), 'utf8'));
    const { robots } = summary;
    assert.equal(await page.$eval('tr[data-name="Content hash"]', (row) => row.children[1].textContent),
      summary.content_hash);
    const drawn = await page.$$eval('tr[data-name="Energy drawn"] td[data-value]',
      (cells) => cells.map((cell) => Number(cell.dataset.value)));
    assert.equal(drawn.length, 3);
    drawn.forEach((energy, i) =>
      assert.ok(Math.abs(energy - robots[i].energy_j) <= 1e-9 * energy, `robot ${i}: ${energy}`));
    assert.equal((await page.$$('details.row')).length, 3);
    const end = await canvas(page);
    await moveSlider(page, 0);
    assert.notEqual(await canvas(page), end);
    assert.deepEqual(complaints, []);
    await page.close();
  },
  async 'ticks have the decimals of their step and no negative zero'() {
    const { tickTexts } = await import(pathToFileURL('tools/report/src/elements.js'));
    assert.deepEqual(tickTexts([-0.0002, -0, 0.0002, 0.0004]), ['\u22120.0002', '0.0000', '0.0002', '0.0004']);
    assert.deepEqual(tickTexts([-1e-20, 0.25, 0.5]), ['0.00', '0.25', '0.50']);
    assert.deepEqual(tickTexts([-0.30000000000000004, -0.2, -0.1]), ['\u22120.3', '\u22120.2', '\u22120.1']);
    assert.deepEqual(tickTexts([-12000, null, 14500]), ['\u221212\u2009000', '', '14\u2009500']);
    assert.deepEqual(tickTexts([0]), ['0']);
  },
  async 'figures of a campaign are those of runs.csv'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'out/soils/report.html'));
    const runs = readTable('soils', 'runs.csv');
    const near = (got, wanted, name) =>
      assert.ok(Math.abs(got - wanted) <= 1e-9 * Math.max(1e-6, Math.abs(wanted)), `${name}: ${got}, not ${wanted}`);
    const mean = (list) => list.reduce((sum, it) => sum + it, 0) / list.length;
    for (const metric of ['energy_j', 'terrain_after.relief_m']) {
      const { metrics } = await facts(page);
      await page.select('select[aria-label=Metric]', String(metrics.findIndex((it) => it.name === metric)));
      await waitFor(page, (name) => document.querySelector('[data-metric]')?.dataset.metric === name &&
        document.querySelector('[data-name="cell 5"]') !== null, metric);
      for (let cell = 0; cell < 6; ++cell) {
        const of = (at) => runs.filter((run) => Number(run.cell) === at).map((run) => Number(run[metric]));
        const shown = await page.$eval(`tr[data-name="cell ${cell}"]`,
          (row) => ({ text: row.textContent,
            numbers: [...row.querySelectorAll('td[data-value]')].map((it) => Number(it.dataset.value)),
          intervals: [...row.querySelectorAll('.interval')].map((it) =>
            [Number(it.dataset.low), Number(it.dataset.high)]) }));
        assert.ok(shown.text.startsWith(runs[5 * cell]['experiment.algorithm'] + runs[5 * cell]['soil.preset']),
          shown.text);
        assert.equal(shown.numbers[0], 5);
        near(shown.numbers[1], mean(of(cell)), `${metric} of cell ${cell}`);
        const [low, high] = shown.intervals[0];
        assert.ok(low <= shown.numbers[1] && shown.numbers[1] <= high && low >= Math.min(...of(cell)) &&
          high <= Math.max(...of(cell)), `${low} to ${high}`);
        if (cell === 1) assert.equal(shown.numbers.length, 3, 'the baseline is not compared with itself');
        else near(shown.numbers[2], mean(of(cell).map((value, seed) => value - of(1)[seed])),
          `difference of cell ${cell}`);
      }
    }
    assert.deepEqual(complaints, []);
    await page.close();
  },
  async 'curves of a campaign are those of curves.csv, and one stands for its cells'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'out/soils/report.html'));
    const { curves } = await facts(page);
    assert.ok(curves.length >= 4, 'progress, relief, roughness, flat share');
    for (const name of ['relief', 'progress']) {
      await page.select('select[aria-label=Curve]', String(curves.findIndex((it) => it.name === name)));
      await waitFor(page, (wanted) => document.querySelector('[data-curve]')?.dataset.curve === wanted, name);
      const end = Math.max(...readTable('soils', 'curves.csv').map((point) => Number(point.time)));
      for (let cell = 0; cell < 6; ++cell) {
        const values = readTable('soils', 'curves.csv').filter((point) => Math.floor(Number(point.run) / 5) === cell &&
          Number(point.time) === end).map((point) => Number(point[name]));
        assert.equal(values.length, 5);
        const mean = values.reduce((sum, it) => sum + it, 0) / 5;
        const shown = await page.$eval(`tr[data-name="curve of cell ${cell}"]`,
          (row) => ({ mean: Number([...row.querySelectorAll('td[data-value]')].at(-1).dataset.value),
            interval: { ...[...row.querySelectorAll('.interval')].at(-1).dataset } }));
        assert.ok(Math.abs(shown.mean - mean) <= 1e-9 * Math.abs(mean),
          `${name} of cell ${cell}: ${shown.mean}, not ${mean}`);
        assert.ok(Number(shown.interval.low) <= mean && mean <= Number(shown.interval.high));
      }
      assert.equal(await page.$eval('[data-curve] .u-legend',
        (it) => [...it.querySelectorAll('.u-series')].filter((row) =>
          getComputedStyle(row).display !== 'none').length), 1 + 6, 'time and cells; no bands');
    }
    assert.deepEqual(complaints, []);
    await page.close();
    const samples = await openReport(browser, join(folder, 'out/samples/report.html'));
    assert.match(await samples.page.$eval('body', (it) => it.textContent),
      /Curves over time are drawn of at most 12 cells\./);
    await samples.page.close();
  },
  async 'a campaign leads to its runs, says how they ended, and draws samples over their factor'(browser) {
    const { page, complaints } = await openReport(browser, join(folder, 'out/soils/report.html'), { scheme: 'dark' });
    assert.deepEqual(await page.$$eval('[data-column] .mean', (all) => all.length), 6 + 5 + 6 + 2 + 3,
      'cells, differences, ranks, levels');
    const ended = await page.$$eval('tr[data-name^="ends of cell"]',
      (rows) => rows.map((row) => Number(row.querySelector('td[data-value]').dataset.value)));
    assert.deepEqual(ended, [5, 5, 5, 5, 5, 5]);
    const links = await page.$$eval('details.runs a', (all) => all.map((it) => decodeURI(new URL(it.href).pathname)));
    assert.equal(links.length, 30);
    for (const link of links) assert.ok(existsSync(join(link, 'session.h5')), link);
    await page.close();
    const samples = await openReport(browser, join(folder, 'out/samples/report.html'));
    assert.equal(await samples.page.$$eval('[data-factor="parameters.walk_speed_max"] .single', (all) => all.length),
      15);
    assert.deepEqual([...complaints, ...samples.complaints], []);
    await samples.page.close();
  },
  async 'an incomplete campaign has a page only on request, which says so'(browser) {
    cpSync(join(folder, 'out/soils'), join(folder, 'out/part'), { recursive: true });
    for (const file of readdirSync(join(folder, 'out/part/results'))) {
      const path = join(folder, 'out/part/results', file);
      writeFileSync(path, readFileSync(path, 'utf8').split('\n').slice(1).join('\n'));
    }
    assert.throws(() => execFileSync(program, ['report', 'out/part'],
      { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] }), (error) => {
      const text = String(error.stderr);
      assert.match(text, /^screed: out\/part: \d+ of 30 runs done, \d+ missing; .*--incomplete\n$/);
      return true;
    });
    screed('report', 'out/part', '--incomplete');
    const { page, complaints } = await openReport(browser, join(folder, 'out/part/report.html'));
    assert.match(await page.$eval('.warning', (it) => it.textContent), /^Incomplete: \d of 30 runs/);
    assert.deepEqual(complaints, []);
    await page.close();
  },
  async 'no key of the radio is on the page, and a page stays small'() {
    const text = readFileSync(join(folder, 'rigid.html'), 'utf8');
    assert.ok(readFileSync(join(folder, 'rigid', 'experiment.ini'), 'utf8').includes(key), 'the run has the key');
    assert.ok(!text.includes(key));
    assert.ok(statSync(join(folder, 'soil.html')).size < 5e6);
  },
};

/// A campaign of two algorithms on two soils, and its page.
function runCampaign(name, text, ...options) {
  writeFileSync(join(folder, `${name}.ini`), text);
  screed('campaign', 'run', `${name}.ini`, '--quiet');
  screed('campaign', 'merge', join('out', name));
  screed('report', join('out', name), ...options);
  return join(folder, 'out', name, 'report.html');
}

/// Rows of a campaign's table, as objects.
function readTable(name, file) {
  const [head, ...lines] = readFileSync(join(folder, 'out', name, file), 'utf8').trimEnd().split('\n');
  return lines.map((line) => Object.fromEntries(line.split(',').map((cell, i) => [head.split(',')[i], cell])));
}

record('soil', soil, '--heights');
record('rigid', `[experiment]\nduration = 12\nseed = 2\n[map]\nsize = 2\nedges = walls\n[radio]\nkey = ${key}\n`);
record('several', '[experiment]\nduration = 12\n[map]\nsize = 3\nedges = walls\n[robots]\ncount = 3\n');
runCampaign('soils', `[campaign]
experiment = soil.ini
seeds = 1..5
keep = session
[set]
experiment.duration = 8
map.ramp = 5
[grid]
experiment.algorithm = random_walk, spin_on_peak
soil.preset = gravel, viper, lete_sand
`, '--metric', 'energy_j', '--baseline', '1');
runCampaign('samples', `[campaign]
experiment = rigid.ini
[set]
experiment.duration = 10
[latin_hypercube]
count = 15
parameters.walk_speed_max = 100..200
`, '--metric', 'distance_m');
const browser = await startBrowser();
let failed = 0;
for (const [name, test] of Object.entries({ ...tests, ...mcapTests(screed, folder) })) {
  try {
    await test(browser);
  } catch (error) {
    ++failed;
    console.log(`failed: ${name}\n${error.stack}`);
  }
  // Of a test that failed, its page.
  for (const page of await browser.pages()) if (page.url() !== 'about:blank') await page.close();
}
await browser.close();
console.log(`${Object.keys(tests).length - failed} passed, ${failed} failed`);
process.exitCode = failed === 0 ? 0 : 1;
