// `screed session export --mcap` and `screed decode --mcap`, read by Foxglove's libraries, against
// the CSV, the session's own bytes and the published schemas. `screed` runs the program in `folder`, which has the runs
// "soil", "rigid" and "several" of report_test.mjs.
import { parse as parseRos } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg-serialization';
import * as foxglove from '@foxglove/schemas/jsonschema.js';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { Ajv } from 'ajv';
import { decode as decodePng } from 'fast-png';
import { decompress } from 'fzstd';
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';

const decompressHandlers = { zstd: (bytes) => decompress(bytes) };

/// A file in memory as McapIndexedReader wants it.
function readable(bytes) {
  return {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
}

/// All that a file holds: by its index, with checksums on, and once more as a stream.
async function readMcap(path) {
  const bytes = readFileSync(path);
  const reader = await McapIndexedReader.Initialize({ readable: readable(bytes), decompressHandlers });
  const topics = new Map();
  for (const channel of reader.channelsById.values()) {
    topics.set(channel.topic, { channel, schema: reader.schemasById.get(channel.schemaId), messages: [] });
  }
  let last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    assert.ok(message.logTime >= last, 'messages come in order of time');
    last = message.logTime;
    topics.get(reader.channelsById.get(message.channelId).topic).messages.push(message);
  }
  for (const topic of topics.values()) {
    assert.equal(BigInt(topic.messages.length), reader.statistics.channelMessageCounts.get(topic.channel.id));
  }
  const metadata = new Map();
  for await (const it of reader.readMetadata()) metadata.set(it.name, it.metadata);
  const attachments = new Map();
  for await (const it of reader.readAttachments({ validateCrcs: true })) {
    attachments.set(it.name, Buffer.from(it.data).toString());
  }
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(bytes);
  let streamed = 0n;
  for (let record; (record = stream.nextRecord());) if (record.type === 'Message') ++streamed;
  assert.ok(stream.done());
  assert.equal(streamed, reader.statistics.messageCount);
  return { topics, metadata, attachments };
}

const json = (message) => JSON.parse(Buffer.from(message.data).toString());
const seconds = (time) => time.sec + time.nsec / 1e9;

/// Columns of a topic in the encoding of ROS 1.
function rosColumns(topic) {
  assert.equal(topic.channel.messageEncoding, 'ros1');
  assert.equal(topic.schema.encoding, 'ros1msg');
  const reader = new MessageReader(parseRos(Buffer.from(topic.schema.data).toString()));
  const rows = topic.messages.map((message) => reader.readMessage(message.data));
  return { rows, names: Object.keys(rows[0]) };
}

/// The rows of a topic are the lines of a CSV file, to the last bit.
function equalsCsv(topic, path) {
  const [head, ...lines] = readFileSync(path, 'utf8').trimEnd().split('\n');
  const names = head.split(',').map((title) => title.replace(/ \[.*\]$/, ''));
  const { rows } = rosColumns(topic);
  assert.equal(rows.length, lines.length);
  let values = 0;
  lines.forEach((line, i) => line.split(',').forEach((cell, column) => {
    if (names[column] === 'frame') return;
    assert.ok(Object.is(rows[i][names[column]], Number(cell)), `${path}, line ${i + 2}, ${names[column]}`);
    ++values;
  }));
  return values;
}

export const mcapTests = (screed, folder) => {
  const exported = async (run, ...options) => {
    screed('session', 'export', run, '--mcap', '--out', `${run}_mcap`, ...options);
    return readMcap(join(folder, `${run}_mcap`, 'run.mcap'));
  };
  /// The numbers of a table or an attribute of a session, one after the other, as HDF5's own tool reads them.
  const sessionNumbers = (session, ...what) => {
    const text = execFileSync('h5dump', [...what, join(folder, session)], { encoding: 'utf8', maxBuffer: 1e9 });
    const data = text.slice(text.indexOf('DATA {') + 6).split('ATTRIBUTE')[0];
    return data.replaceAll(/\(\d+\):/g, '').match(/-?\d+/g).map(Number);
  };

  return {
    async 'MCAP of several robots: each frame is the CSV, each sample and output the session'() {
      const { topics } = await exported('several');
      for (const robot of [0, 1, 2]) {
        const run = robot === 0 ? 'several' : join('several', `robot_${robot}`);
        const frames = topics.get(`/robot_${robot}/frames`);
        assert.equal(equalsCsv(frames, join(folder, run, 'frames.csv')), 1200 * 42);
        for (const table of ['samples', 'outputs']) {
          const topic = topics.get(`/robot_${robot}/${table}`);
          const numbers = rosColumns(topic).rows.flatMap((row) =>
            Object.values(row).flatMap((it) => (typeof it === 'number' ? it : Array.from(it))));
          assert.deepEqual(numbers, sessionNumbers(join(run, 'session.h5'), '-d', table), `${table} of robot ${robot}`);
          assert.deepEqual(topic.messages.map((it) => it.logTime),
            topic.messages.map((_, i) => BigInt(i + 1) * 10000000n));
        }
      }
    },
    async 'MCAP: poses, bodies, terrain and events are what the schemas of Foxglove say'() {
      const { topics } = await exported('several');
      const ajv = new Ajv({ strict: false });
      ajv.addFormat('uri', true);
      for (const [name, schema] of [['/tf', 'FrameTransforms'], ['/terrain', 'SceneUpdate'], ['/robots', 'SceneUpdate'],
        ['/heights', 'Grid'], ['/events', 'Log']]) {
        const topic = topics.get(name);
        assert.equal(topic.schema.name, `foxglove.${schema}`);
        const own = ajv.compile(JSON.parse(Buffer.from(topic.schema.data).toString()));
        const published = ajv.compile(foxglove[schema]);
        assert.ok(topic.messages.length > 0, name);
        for (const message of topic.messages) {
          assert.ok(own(json(message)), `${name}: ${ajv.errorsText(own.errors)}`);
          assert.ok(published(json(message)), `${name}: ${ajv.errorsText(published.errors)}`);
        }
      }
    },
    async 'MCAP: a pose stands where the frames say, turned as they say'() {
      const { topics } = await exported('several');
      const frames = rosColumns(topics.get('/robot_1/frames')).rows;
      for (const message of topics.get('/tf').messages) {
        const pose = json(message).transforms.find((it) => it.child_frame_id === 'robot_1');
        const frame = frames[Math.round(seconds(pose.timestamp) * 100) - 1];
        assert.deepEqual([pose.translation.x, pose.translation.y, pose.translation.z], [frame.x, frame.y, frame.z]);
        const { x, y, z, w } = pose.rotation;
        // Where the robot's forward and left axes point: nose up and left side up are positive.
        const forward = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)];
        const leftUp = 2 * (y * z + x * w);
        const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-12, `${a} is not ${b}`);
        near(forward[2], Math.sin(frame.pitch));
        near(leftUp, Math.sin(frame.roll) * Math.cos(frame.pitch));
        near(Math.atan2(forward[1], forward[0]), frame.yaw);
      }
    },
    async 'MCAP: heights are those of the PNG series, the drawn terrain lies on them, the curve is the CSV'() {
      const { topics } = await exported('soil', '--every', '500');
      screed('session', 'export', 'soil', '--heights', '--all', '--first', '499', '--every', '500',
        '--out', 'soil_png');
      const scale = JSON.parse(readFileSync(join(folder, 'soil_png', 'heights', 'scale.json'), 'utf8'));
      const grids = topics.get('/heights').messages.map(json);
      assert.equal(grids.length, 9);
      assert.equal(scale.frames.length, 8);
      scale.frames.forEach(({ frame, file }, i) => {
        const image = decodePng(readFileSync(join(folder, 'soil_png', 'heights', file)));
        const grid = grids[i + 1];
        assert.equal(seconds(grid.timestamp), (frame + 1) / 100);
        assert.equal(grid.column_count, image.width);
        const heights = new Float32Array(new Uint8Array(Buffer.from(grid.data, 'base64')).buffer);
        assert.equal(heights.length, image.width * image.height);
        heights.forEach((height, node) => {
          const row = image.height - 1 - Math.floor(node / image.width);
          const sample = image.data[row * image.width + (node % image.width)];
          const recorded = scale.black_m + (sample * (scale.white_m - scale.black_m)) / 65535;
          assert.ok(Math.abs(height - recorded) <= scale.m_per_sample_step, `node ${node} of ${file}`);
        });
        assert.ok(Math.abs(grid.pose.position.x + 0.5 * grid.cell_size.x - scale.west_m) < 1e-12);
        assert.ok(Math.abs(grid.pose.position.y + 0.5 * grid.cell_size.y - scale.south_m) < 1e-12);
      });

      const scenes = topics.get('/terrain').messages.map(json);
      assert.deepEqual(scenes.map((it) => it.entities[0].id), grids.map(() => 'terrain'));
      const drawn = scenes.at(-1).entities[0].triangles[0];
      const end = grids.at(-1);
      const heights = new Float32Array(new Uint8Array(Buffer.from(end.data, 'base64')).buffer);
      const mean = (list) => list.reduce((sum, it) => sum + it, 0) / list.length;
      const spacing = drawn.points[1].x - drawn.points[0].x;
      assert.ok(Math.abs(spacing / end.cell_size.x - Math.round(spacing / end.cell_size.x)) < 1e-3);
      assert.ok(Math.abs(mean(drawn.points.map((it) => it.z)) - mean(Array.from(heights))) < 1e-4);
      assert.equal(drawn.colors.length, drawn.points.length);
      assert.ok(Math.max(...drawn.indices) === drawn.points.length - 1);
      for (let corner = 0; corner < drawn.indices.length; corner += 3) {
        const [a, b, c] = [0, 1, 2].map((it) => drawn.points[drawn.indices[corner + it]]);
        assert.ok((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0, 'triangles are seen from above');
      }

      screed('session', 'export', 'soil', '--leveling', '--out', 'soil_curve');
      assert.ok(equalsCsv(topics.get('/leveling'), join(folder, 'soil_curve', 'leveling.csv')) > 0);
    },
    async 'MCAP: says what the run was, without the key of the radio; compressed; the same run, the same bytes'() {
      const { metadata, attachments, topics } = await exported('rigid');
      const summary = JSON.parse(readFileSync(join(folder, 'rigid', 'summary.json'), 'utf8'));
      assert.equal(metadata.get('run').get('content_hash'), summary.content_hash);
      assert.equal(metadata.get('run').get('seed'), '2');
      for (const name of ['walk_speed_max', 'random_seed']) {
        assert.deepEqual([Number(metadata.get('parameters').get(name))],
          sessionNumbers('rigid/session.h5', '-a', `/parameters/${name}`));
      }
      assert.deepEqual(JSON.parse(attachments.get('summary.json')), summary);
      assert.match(attachments.get('experiment.ini'), /^seed = 2$/m);
      const path = join(folder, 'rigid_mcap', 'run.mcap');
      const [key] = readFileSync(join(folder, 'rigid', 'experiment.ini'), 'utf8').match(/[0-9a-f]{32}/);
      for (const text of attachments.values()) assert.ok(!text.includes(key));
      const raw = [...topics.values()].flatMap((it) => it.messages).reduce((sum, it) => sum + it.data.length, 0);
      assert.ok(statSync(path).size < 0.6 * raw, `${statSync(path).size} of ${raw} bytes`);
      const before = readFileSync(path);
      await exported('rigid');
      assert.ok(readFileSync(path).equals(before));
      const texts = topics.get('/events').messages.map((it) => json(it).message);
      assert.ok(texts.includes('armed') || texts.includes('running'), texts.join(', '));
    },
    async 'MCAP of a range has its frames alone'() {
      const { topics } = await exported('rigid', '--first', '300', '--count', '200');
      const messages = topics.get('/robot_0/frames').messages;
      assert.equal(messages.length, 200);
      assert.equal(messages[0].logTime, 3010000000n);
      // What was so before is no event; ground is there from the first moment on.
      for (const event of topics.get('/events').messages) assert.ok(event.logTime > 3010000000n);
      assert.deepEqual(topics.get('/heights').messages.map((it) => it.logTime), [3000000000n, 5000000000n]);
      const part = await exported('soil', '--first', '1234', '--count', '100', '--every', '50');
      assert.deepEqual(part.topics.get('/terrain').messages.map((it) => it.logTime),
        [12340000000n, 12500000000n, 13000000000n, 13340000000n]);
    },
    async 'MCAP of a radio log is its CSV'() {
      screed('decode', join('several', 'telemetry.log'), '--mcap', '--out', 'radio.mcap');
      screed('decode', join('several', 'telemetry.log'), '--csv', '--out', 'radio_csv');
      const { topics } = await readMcap(join(folder, 'radio.mcap'));
      assert.ok(topics.has('/robot1/attitude'), [...topics.keys()].join(' '));
      for (const message of ['attitude', 'motors']) {
        const [head, ...lines] =
          readFileSync(join(folder, 'radio_csv', `${message}.csv`), 'utf8').trimEnd().split('\n');
        const names = head.split(',').map((title) => title.replace(/ \[.*\]$/, ''));
        const robot = names.indexOf('robot');
        const rows = lines.map((line) => line.split(','));
        for (const number of new Set(rows.map((row) => row[robot]))) {
          const own = rows.filter((row) => row[robot] === number);
          const values = topics.get(`/robot${number}/${message}`).messages.map(json);
          assert.equal(values.length, own.length);
          values.forEach((value, i) => {
            for (const [name, it] of Object.entries(value)) {
              const cell = own[i][names.indexOf(name)];
              assert.equal(it, typeof it === 'string' ? cell : Number(cell), `${message}, line ${i}, ${name}`);
            }
          });
        }
      }
      assert.ok(readdirSync(join(folder, 'radio_csv')).length > 2);
    },
  };
};
