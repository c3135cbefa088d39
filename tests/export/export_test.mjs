// Files for Foxglove and TensorBoard, read back and compared with what is stored: MCAP by the reader of the format's authors.
// Usage: node export_test.mjs ALOFT_PROGRAM SOURCE_FOLDER FOLDER_OF_PACKAGES

import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';

const [aloft, sources, packages] = process.argv.slice(2);
const installed = join(packages, 'node_modules', '.installed');
if (!existsSync(installed) || readFileSync(installed, 'utf8') !== readFileSync(join(sources, 'tests/export/package-lock.json'), 'utf8')) {
  console.log('SKIPPED: exported files, read back: the build had no npm, or no network, to fetch the readers; build again with both');
  process.exit(77);
}
const require = createRequire(packages + '/');
const {McapIndexedReader, McapStreamReader} = require('@mcap/core');
const {createFileRegistry, fromBinary} = require('@bufbuild/protobuf');
const {FileDescriptorSetSchema} = require('@bufbuild/protobuf/wkt');
const {BinaryReader} = require('@bufbuild/protobuf/wire');
const {foxgloveMessageSchemas} = require('@foxglove/schemas/internal');

const scratch = mkdtempSync(join(tmpdir(), 'aloft-export-test-'));
after(() => rmSync(scratch, {recursive: true, force: true}));
const experiment = join(scratch, 'experiment.json');
const results = join(scratch, 'results');
const agents = ['min-height', 'constant-120', 'constant-77', 'planner', 'dqn'];
const trials = 2;

function run(...given) {
  return spawnSync(aloft, given, {cwd: sources, encoding: 'utf8', timeout: 120000, maxBuffer: 1 << 28});
}

function succeed(...given) {
  const {status, stderr, stdout} = run(...given);
  assert.equal(status, 0, `aloft ${given.join(' ')}: ${stderr}`);
  return stdout;
}

before(() => {
  const worlds = [
    {name: 'city', bs_density_per_km2: [1, 5], building_density_per_km2: 100, window_m: 2000, steps: 12},
    {name: 'measured', kind: 'measured', file: join(sources, 'data/samples/measured_sample.csv'), sites_file: join(sources, 'data/samples/measured_sample.sites.csv')},
  ];
  // 10 m in 0.8 s.
  writeFileSync(experiment, JSON.stringify({name: 'small', seed: 3, trials, speed_m_per_s: 12.5, worlds, agents}));
  succeed('run', experiment, '--out', results, '--in-process');
});

/** All of a file: its records in order, and its messages decoded by the schemas that it brings along. */
function read(file) {
  const reader = new McapStreamReader({validateCrcs: true});
  reader.append(readFileSync(file));
  const records = [];
  for (let record; (record = reader.nextRecord()) !== undefined;) records.push(record);
  assert.ok(reader.done(), 'the file ends where it should');
  const schemas = new Map();
  const channels = new Map();
  const messages = [];
  for (const record of records) {
    if (record.type === 'Schema' && !schemas.has(record.id)) {
      assert.equal(record.encoding, 'protobuf');
      const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, record.data));
      schemas.set(record.id, registry.getMessage(record.name));
      assert.ok(schemas.get(record.id), `the schema of ${record.name} has this message`);
    }
    if (record.type === 'Channel') channels.set(record.id, record);
    if (record.type === 'Message') {
      const {topic, schemaId} = channels.get(record.channelId);
      messages.push({topic, bytes: record.data.length + 31, channelId: record.channelId, sequence: record.sequence, time: record.logTime, published: record.publishTime, ...decode(schemas.get(schemaId), record.data)});
    }
  }
  return {records, schemas, channels, messages};
}

const decode = (schema, data) => ({type: schema.typeName, content: fromBinary(schema, data)});
const nanoseconds = ({seconds, nanos}) => seconds * 1000000000n + BigInt(nanos);

/** Foxglove's name of the type of one of our fields. */
function typeName(field) {
  const {fieldKind, listKind} = field;
  if (fieldKind === 'message' || listKind === 'message') return {'google.protobuf.Timestamp': 'Timestamp', 'google.protobuf.Duration': 'Duration'}[field.message.typeName] ?? field.message.name;
  if (fieldKind === 'enum') return field.enum.name;
  return {1: 'float64', 7: 'uint32', 8: 'boolean', 9: 'string', 12: 'bytes'}[field.scalar];
}

function theirTypeName({type}) {
  return {primitive: () => type.name, nested: () => type.schema.name, enum: () => type.enum.protobufEnumName}[type.type]();
}

/** Checks a message, and those in it, against what Foxglove publishes; returns their names. */
function checkAgainstFoxglove(message, seen = new Set()) {
  if (seen.has(message.name) || message.typeName.startsWith('google.')) return seen;
  seen.add(message.name);
  const theirs = foxgloveMessageSchemas[message.name];
  assert.ok(theirs, `Foxglove has no ${message.name}`);
  const ours = new Map(message.fields.map((field) => [field.name, field]));
  assert.deepEqual([...ours.keys()].sort(), theirs.fields.map(({name}) => name).sort(), message.name);
  theirs.fields.forEach((field, index) => {
    const mine = ours.get(field.name);
    const where = `${message.name}.${field.name}`;
    assert.equal(mine.number, field.protobufFieldNumber ?? index + 1, where);
    assert.equal(mine.fieldKind === 'list', field.array !== undefined, where);
    assert.equal(typeName(mine), theirTypeName(field), where);
    if (field.type.type === 'enum') assert.deepEqual(mine.enum.values.map(({name, number}) => [name, number]), field.type.enum.values.map(({name, value}) => [name, value]), where);
    if (mine.message) checkAgainstFoxglove(mine.message, seen);
  });
  return seen;
}

function recording(...given) {
  const file = join(scratch, `${given.join('') || 'all'}.mcap`);
  assert.equal(succeed('export', results, '--format', 'mcap', '--out', file, ...given), `${file}\n`);
  return file;
}

const rows = (...given) => JSON.parse(succeed('export', results, '--steps', '--format', 'json', ...given));
const world = (condition, trial) => JSON.parse(succeed('inspect', 'world', experiment, '--condition', `${condition}`, '--trial', `${trial}`));

/** CRC-32C, bit by bit. */
function crc32c(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >>> 1) ^ 0x82f63b78 : crc >>> 1;
  }
  return (crc ^ 0xffffffff) >>> 0;
}

/** As TensorFlow stores checksums of records. */
function masked(crc) {
  return (((crc >>> 15) | (crc << 17)) + 0xa282ead8) >>> 0;
}

/** A message as [field number, value] pairs; `kinds`: how to read each field. */
function fields(bytes, kinds) {
  const reader = new BinaryReader(bytes);
  const found = [];
  while (reader.pos < reader.len) {
    const [number] = reader.tag();
    assert.ok(kinds[number], `field ${number} is unknown`);
    found.push([number, reader[kinds[number]]()]);
  }
  return found;
}

/** The events of a file, with their checksums checked: [{wallTime, step, version, scalars}]. */
function readEvents(file) {
  const bytes = readFileSync(file);
  const events = [];
  for (let at = 0; at < bytes.length;) {
    const length = Number(bytes.readBigUInt64LE(at));
    assert.equal(bytes.readUInt32LE(at + 8), masked(crc32c(bytes.subarray(at, at + 8))), 'checksum of a length');
    const content = bytes.subarray(at + 12, at + 12 + length);
    assert.equal(bytes.readUInt32LE(at + 12 + length), masked(crc32c(content)), 'checksum of an event');
    const event = Object.fromEntries(fields(content, {1: 'double', 2: 'int64', 3: 'string', 5: 'bytes'}));
    const values = event[5] ? fields(event[5], {1: 'bytes'}).map(([, value]) => Object.fromEntries(fields(value, {1: 'string', 2: 'float'}))) : [];
    events.push({wallTime: event[1] ?? 0, step: Number(event[2] ?? 0), version: event[3], scalars: Object.fromEntries(values.map((value) => [value[1], value[2]]))});
    at += 16 + length;
  }
  assert.deepEqual(events[0], {wallTime: 0, step: 0, version: 'brain.Event:2', scalars: {}});
  return events.slice(1);
}

/** The event files in a folder, by the names of their runs. */
function runsIn(folder) {
  const files = readdirSync(folder, {recursive: true}).filter((name) => name.includes('tfevents'));
  return new Map(files.map((name) => [dirname(name), readEvents(join(folder, name))]));
}

test('every step of every flight is in the recording, with the values of the rows', () => {
  const {messages} = read(recording());
  const steps = messages.filter(({type}) => type === 'aloft.Step');
  const stored = rows();
  assert.equal(steps.length, stored.length);
  const key = ({condition, trial, agent, step}) => `${condition}/${trial}/${agent}/${step}`;
  const byKey = new Map(stored.map((row) => [key(row), row]));
  for (const {topic, content} of steps) {
    const row = byKey.get(key(content));
    assert.equal(topic, `/${row.agent}/step`);
    const {flown_by, x_m, y_m, height_m, serving_cell, serving_sinr_db, qos_unit, energy_j, q_down, q_hold, q_up, action, qos, reward, epsilon, loss} = row;
    const given = {action, flownBy: flown_by, xM: x_m, yM: y_m, heightM: height_m, servingCell: serving_cell, servingSinrDb: serving_sinr_db, qos, qosUnit: qos_unit, reward, energyJ: energy_j};
    for (const [name, value] of Object.entries(given)) assert.equal(content[name], value, `${key(row)}: ${name}`);
    for (const [name, value] of Object.entries({epsilon, loss, qDown: q_down, qHold: q_hold, qUp: q_up})) assert.equal(content[name] ?? null, value, `${key(row)}: ${name}`);
  }
  assert.ok(steps.some(({content}) => content.epsilon > 0), 'dqn tells what it thinks');
});

test('worlds follow each other in time, agents fly side by side, a step lasts as long as its way', () => {
  const {messages} = read(recording());
  for (const {time, published, content} of messages) {
    assert.equal(published, time);
    if (content.timestamp) assert.equal(nanoseconds(content.timestamp), time);
  }
  assert.ok(messages.every(({time}, i) => i === 0 || time >= messages[i - 1].time), 'in the order of time');
  let begin = 0n;
  let last = 0;
  for (const {topic, time, type, content} of messages) {
    if (topic === '/world') {
      assert.equal(time, begin + (last > 0 ? BigInt(last + 1) * 800000000n : 0n));
      begin = time;
    } else if (type === 'aloft.Step') {
      assert.equal(time, begin + BigInt(content.step) * 800000000n);
      last = content.step;
    }
  }
  const worlds = messages.filter(({topic}) => topic === '/world').map(({content}) => Object.fromEntries(content.entities[0].metadata.map(({key, value}) => [key, value])));
  assert.deepEqual(worlds.map(({trial, bs_density_per_km2}) => [trial, bs_density_per_km2]), [['0', '1'], ['1', '1'], ['0', '5'], ['1', '5'], ['0', undefined], ['1', undefined]]);
  assert.match(worlds[0].condition, /bs_density_per_km2=1/);
});

test('the city is the one of the flight: buildings, base stations, route and serving beam', () => {
  const {messages} = read(recording('--condition', '1', '--trial', '1'));
  const city = world(1, 1);
  const scenes = messages.filter(({topic}) => topic === '/world');
  assert.equal(scenes.length, 1);
  const [{content: scene}] = scenes;
  assert.deepEqual(scene.deletions.map(({type}) => type), [1]); // all of the world before
  const entity = (update, id) => update.entities.find((one) => one.id === id);
  const cubes = entity(scene, 'buildings').cubes;
  assert.ok(cubes.length > 300, `${cubes.length} buildings`);
  assert.ok(scenes[0].bytes * 1800 / cubes.length < 0.25e6, 'about 0.2 MB for 1,800 buildings');
  assert.deepEqual(cubes.map(({pose: {position}, size}) => [position.x, position.y, position.z, size.x, size.y, size.z]), city.buildings.map(({x_m, y_m, height_m}) => [x_m, y_m, height_m / 2, city.building_width_m, city.building_width_m, height_m]));
  const masts = entity(scene, 'base stations');
  assert.deepEqual(masts.cylinders.map(({pose: {position}, size}) => [position.x, position.y, position.z, size.z]), city.base_stations.map(({x_m, y_m, height_m}) => [x_m, y_m, height_m / 2, height_m]));
  assert.deepEqual(masts.texts.map(({text}) => text), city.base_stations.map((_, cell) => `${cell}`));
  assert.deepEqual(entity(scene, 'route').lines[0].points.map(({x, y, z}) => [x, y, z]), city.route.map(({x_m, y_m}) => [x_m, y_m, 0]));

  for (const agent of agents) {
    const flight = rows('--condition', '1', '--trial', '1', '--agents', agent);
    const updates = messages.filter(({topic}) => topic === `/${agent}/scene`).map(({content}) => content);
    assert.equal(updates.length, 1 + flight.length);
    const bytes = messages.filter(({topic}) => topic.startsWith(`/${agent}/`)).reduce((sum, message) => sum + message.bytes, 0);
    assert.ok(bytes / flight.length < 0.85e3, `${bytes / flight.length} bytes, about 0.8 kB, for each step`);
    const way = flight.map(({x_m, y_m, height_m}) => [x_m, y_m, height_m]);
    assert.deepEqual(entity(updates[0], 'flight').lines[0].points.map(({x, y, z}) => [x, y, z]), way);
    flight.forEach(({serving_cell}, i) => {
      const uav = entity(updates[i + 1], 'uav');
      const {x, y, z} = uav.spheres[0].pose.position;
      assert.deepEqual([x, y, z], way[i]);
      assert.equal(uav.texts[0].text, agent);
      const station = city.base_stations[serving_cell];
      assert.deepEqual(entity(updates[i + 1], 'serving beam').lines[0].points.map(({x, y, z}) => [x, y, z]), [way[i], [station.x_m, station.y_m, station.height_m]]);
    });
    // A turned or colourless shape would not be seen where it is.
    for (const update of [scene, ...updates])
      for (const {frameId, cubes, cylinders, spheres, lines, texts} of update.entities) {
        assert.equal(frameId, 'world');
        for (const {pose, color} of [...cubes, ...cylinders, ...spheres, ...lines, ...texts]) assert.deepEqual([pose.orientation.w, color.a], [1, 1]);
      }
  }
});

test('places of a generated world lie around 0 N 0 E, those of a measured flight where it was', () => {
  const {messages} = read(recording('--trial', '0', '--agents', 'planner'));
  const fixes = messages.filter(({type}) => type === 'foxglove.LocationFix').map(({content}) => content);
  const flights = rows('--trial', '0', '--agents', 'planner');
  assert.equal(fixes.length, flights.length);
  const [header, ...lines] = readFileSync(join(sources, 'data/samples/measured_sample.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
  const places = new Map(lines.map((line) => [Number(line[0]), ['latitude', 'longitude'].map((name) => Number(line[header.indexOf(name)]))]));
  fixes.forEach(({latitude, longitude, altitude}, i) => {
    const {condition, step, x_m, y_m, height_m} = flights[i];
    // A degree at the equator of WGS 84: 110,574 m to the north, 111,320 m to the east.
    const expected = condition === 'measured' ? places.get(step) : [y_m / 110574, x_m / 111320];
    assert.ok(Math.abs(latitude - expected[0]) < 1e-7 && Math.abs(longitude - expected[1]) < 1e-7, `${condition}, step ${step}: ${latitude} ${longitude}, not ${expected}`);
    assert.equal(altitude, height_m);
  });
});

test('the beam of a measured flight ends at its base station', () => {
  const {messages} = read(recording('--condition', 'measured', '--agents', 'min-height'));
  const masts = messages.find(({topic}) => topic === '/world').content.entities.find(({id}) => id === 'base stations');
  const place = new Map(masts.texts.map(({text}, i) => [Number(text), masts.cylinders[i].pose.position]));
  let beams = 0;
  for (let i = 0; i < messages.length; ++i) {
    if (messages[i].type !== 'aloft.Step') continue;
    const beam = messages[i - 2].content.entities.find(({id}) => id === 'serving beam').lines;
    const station = place.get(messages[i].content.servingCell);
    if (station === undefined) {
      assert.deepEqual(beam, []);
      continue;
    }
    assert.deepEqual([beam[0].points[1].x, beam[0].points[1].y], [station.x, station.y]);
    ++beams;
  }
  assert.ok(beams > 0);
});

test('a measured flight without places goes up and down at 0 N 0 E, and its file must be there; a route that depends on the flight is not drawn', () => {
  const grid = join(scratch, 'grid.csv');
  writeFileSync(grid, 'step,height_m,throughput_kbps\n' + [1, 2, 3].flatMap((step) => [20, 30, 40].map((height) => `${step},${height},${1000 * height}\n`)).join(''));
  const file = join(scratch, 'others.json');
  writeFileSync(file, JSON.stringify({name: 'others', seed: 3, trials: 1, worlds: [{name: 'grid', kind: 'measured', file: grid}, {name: 'serving', route: 'serving', window_m: 2000, steps: 4, bs_antenna: '3gpp', cells_per_site: 'three'}], agents: ['constant-40']}));
  const folder = join(scratch, 'others');
  succeed('run', file, '--out', folder, '--in-process');
  const out = join(scratch, 'others.mcap');
  succeed('export', folder, '--format', 'mcap', '--out', out);
  const {messages} = read(out);
  const fixes = messages.filter(({type}) => type === 'foxglove.LocationFix').map(({content: {latitude, longitude, altitude}}) => [latitude, longitude, altitude]);
  assert.deepEqual(fixes.slice(0, 3), [[0, 0, 30], [0, 0, 40], [0, 0, 40]]);
  assert.equal(fixes.length, 3 + 4);
  const routes = messages.filter(({topic}) => topic === '/world').map(({content}) => content.entities.find(({id}) => id === 'route').lines[0].points);
  assert.deepEqual(routes, [[], []]);
  assert.deepEqual(messages.filter(({type}) => type === 'foxglove.SceneUpdate').flatMap(({content}) => content.entities).filter(({id}) => id === 'serving beam').map(({lines}) => lines.length), [0, 0, 0, 1, 1, 1, 1]);

  // Three cells share a mast.
  const masts = messages.findLast(({topic}) => topic === '/world').content.entities.find(({id}) => id === 'base stations');
  const {base_stations} = JSON.parse(succeed('inspect', 'world', file, '--condition', 'serving'));
  assert.equal(masts.cylinders.length, base_stations.length / 3);
  masts.texts.forEach(({text, pose}, i) => {
    assert.equal(text, `${3 * i}, ${3 * i + 1}, ${3 * i + 2}`);
    for (const cell of text.split(', ')) assert.deepEqual([pose.position.x, pose.position.y], [base_stations[cell].x_m, base_stations[cell].y_m]);
  });

  rmSync(grid);
  rmSync(out);
  const {status, stderr} = run('export', folder, '--format', 'mcap', '--out', out);
  assert.equal(status, 2);
  assert.match(stderr, /grid\.csv/);
  assert.deepEqual(readdirSync(scratch).filter((name) => name.startsWith('others.mcap')), []);
});

test('schemas are those of Foxglove, by names, numbers and types', () => {
  const {schemas} = read(recording('--trial', '0'));
  const names = [...schemas.values()].map(({typeName}) => typeName).sort();
  assert.deepEqual(names, ['aloft.Step', 'foxglove.LocationFix', 'foxglove.SceneUpdate']);
  const seen = new Set();
  for (const schema of schemas.values()) if (schema.typeName.startsWith('foxglove.')) checkAgainstFoxglove(schema, seen);
  assert.ok(seen.has('SceneEntity') && seen.has('LinePrimitive') && seen.size > 15, [...seen].join(' '));
});

test('agents have the colours of the report', () => {
  const page = join(scratch, 'report.html');
  succeed('report', results, '--out', page);
  const [, data] = /id="report-data">(.*?)<\/script>/s.exec(readFileSync(page, 'utf8'));
  const {messages} = read(recording('--trial', '0', '--condition', '0'));
  for (const {name, colour} of JSON.parse(data).agents) {
    const {color} = messages.find(({topic}) => topic === `/${name}/location`).content;
    assert.equal('#' + [color.r, color.g, color.b].map((part) => Math.round(part * 255).toString(16).padStart(2, '0')).join(''), colour.light, name);
  }
});

test('the file is indexed: the index finds every message, by topic and time, and counts them', async () => {
  const file = recording();
  const bytes = readFileSync(file);
  const {messages, records} = read(file);
  const readable = {size: async () => BigInt(bytes.length), read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length))};
  const reader = await McapIndexedReader.Initialize({readable});
  assert.equal(reader.channelsById.size, 1 + 3 * agents.length);
  assert.equal(reader.statistics.messageCount, BigInt(messages.length));
  assert.equal(reader.statistics.channelCount, reader.channelsById.size);
  assert.equal(reader.statistics.schemaCount, 3);
  assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
  assert.equal(reader.statistics.messageStartTime, 0n);
  assert.equal(reader.statistics.messageEndTime, messages.at(-1).time);
  for (const [id, count] of reader.statistics.channelMessageCounts) assert.equal(count, BigInt(messages.filter(({channelId}) => channelId === id).length));
  const dataEnd = records.find(({type}) => type === 'DataEnd');
  assert.notEqual(dataEnd.dataSectionCrc, 0);
  for (const chunk of reader.chunkIndexes) assert.ok(chunk.messageIndexOffsets.size > 0);

  const found = [];
  for await (const message of reader.readMessages({validateCrcs: true})) found.push([message.channelId, message.sequence]);
  assert.deepEqual(found, messages.map(({channelId, sequence}) => [channelId, sequence]));
  const half = messages.at(-1).time / 2n;
  let late = 0;
  for await (const message of reader.readMessages({topics: ['/dqn/step'], startTime: half})) late += message.logTime >= half ? 1 : NaN;
  assert.equal(late, messages.filter(({topic, time}) => topic === '/dqn/step' && time >= half).length);
  const facts = [];
  for await (const {name, metadata} of reader.readMetadata()) facts.push([name, metadata.get('experiment'), metadata.get('seed')]);
  assert.deepEqual(facts, [['aloft', 'small', '3']]);
});

test('the same flights give the same bytes, and a changed byte is noticed', () => {
  const file = recording();
  const bytes = readFileSync(file);
  rmSync(file);
  assert.ok(readFileSync(recording()).equals(bytes));
  const broken = join(scratch, 'broken.mcap');
  bytes[bytes.length >> 1] ^= 1;
  writeFileSync(broken, bytes);
  assert.throws(() => read(broken), /CRC/i);
});

test('TensorBoard: one run per flight, with what happened and what the agent told of its learning', () => {
  assert.equal(crc32c(Buffer.from('123456789')), 0xe3069283);
  const folder = join(scratch, 'events');
  succeed('export', results, '--format', 'tensorboard', '--out', folder);
  const runs = runsIn(folder);
  const conditions = ['0-city_bs_density_per_km2=1', '1-city_bs_density_per_km2=5', '2-measured'];
  assert.deepEqual([...runs.keys()].sort(), conditions.flatMap((condition) => ['0', '1'].flatMap((trial) => agents.map((agent) => `${condition}/trial-${trial}/${agent}`))).sort());
  let thoughts = 0;
  const stored = rows();
  for (const row of stored) {
    const condition = conditions.find((name) => row.condition === 'measured' ? name === '2-measured' : name.endsWith(`=${row.bs_density_per_km2}`));
    const event = runs.get(`${condition}/trial-${row.trial}/${row.agent}`)[row.step - 1];
    assert.equal(event.step, row.step);
    assert.equal(event.wallTime, row.step * 10 / 12.5);
    const expected = {};
    for (const name of ['qos', 'reward', 'height_m', 'serving_sinr_db', 'energy_j']) expected[`flight/${name}`] = Math.fround(row[name]);
    if (row.epsilon !== null) for (const name of ['epsilon', 'loss', 'q_down', 'q_hold', 'q_up']) expected[`learning/${name}`] = Math.fround(row[name]);
    assert.deepEqual(event.scalars, expected);
    thoughts += row.epsilon !== null;
  }
  assert.equal([...runs.values()].flat().length, stored.length);
  assert.ok(thoughts > 0);

  const again = join(scratch, 'events-again');
  succeed('export', results, '--format', 'tensorboard', '--out', `${again}/`, '--trial', '1', '--agents', 'dqn');
  const some = readdirSync(again, {recursive: true}).filter((name) => name.includes('tfevents'));
  assert.equal(some.length, 3);
  for (const name of some) assert.ok(readFileSync(join(again, name)).equals(readFileSync(join(folder, name))));
});

test('TensorBoard: the validation log of a training', () => {
  const config = join(scratch, 'train.json');
  const stage = {worlds: 5, validation_worlds: 3, rounds: 1, hidden_width: 8, updates: 50};
  writeFileSync(config, JSON.stringify({spectral_efficiency: {...stage, rounds: 0}, throughput: {...stage, rollout_steps: 5}}));
  const model = join(scratch, 'model.pb');
  succeed('train', 'pretrained', '--config', config, '--out', model);
  const folder = join(scratch, 'training');
  succeed('export', `${model}.log`, '--format', 'tensorboard', '--out', folder);
  const runs = runsIn(folder);
  const log = readFileSync(`${model}.log`, 'utf8').trim().split('\n');
  assert.equal(log.length, 3);
  assert.deepEqual([...runs.keys()].sort(), ['spectral_efficiency', 'throughput']);
  for (const [name, events] of runs) {
    const lines = log.filter((line) => line.startsWith(name.replace('_', ' ')));
    assert.deepEqual(events.map(({step}) => step), lines.map((_, round) => round));
    events.forEach(({scalars}, round) => {
      const numbers = [...lines[round].matchAll(/[+-]\d+\.\d+/g)].map(([text]) => Math.fround(Number(text)));
      assert.deepEqual(Object.values(scalars), numbers);
      assert.equal(numbers.length, name === 'throughput' ? 2 : 6);
    });
  }
  assert.ok('gain_over_min_height/network_at_2.5_per_km2' in runs.get('spectral_efficiency')[0].scalars);
  assert.ok('gain_over_min_height/best_feasible' in runs.get('throughput')[1].scalars);
});

test('what is wanted of a run: conditions, trials and agents, of rows and recordings', () => {
  assert.equal(rows('--condition', 'measured').every(({condition}) => condition === 'measured'), true);
  const some = rows('--trial', '1', '--agents', 'dqn,planner');
  assert.deepEqual([...new Set(some.map(({trial, agent}) => `${trial} ${agent}`))].sort(), ['1 dqn', '1 planner']);
  const {channels} = read(recording('--trial', '1', '--agents', 'planner,dqn'));
  assert.deepEqual([...channels.values()].map(({topic}) => topic), ['/world', '/planner/scene', '/planner/location', '/planner/step', '/dqn/scene', '/dqn/location', '/dqn/step']);
});

test('wrong requests end with exit code 2, say what to do, and write nothing', () => {
  const out = join(scratch, 'refused');
  const cases = [
    [['--format', 'csv'], /add either --flights, .* or --steps/],
    [['--flights', '--steps'], /add either --flights, .* or --steps/],
    [['--flights', '--out', out], /go to standard output; redirect/],
    [['--format', 'mcap'], /--format mcap needs --out: the file to write/],
    [['--format', 'mcap', '--steps', '--out', out], /--flights and --steps are for --format csv and json/],
    [['--format', 'mcap', '--out', out, '--trial', '2'], /no such flight; 'aloft export .* --flights' lists all/],
    [['--format', 'tensorboard'], /--format tensorboard needs --out: the folder to write/],
    [['--format', 'tensorboard', '--out', scratch], /exists already; remove it, or choose another folder/],
    [['--format', 'tensorboard', '--out', join(out, 'x')], /cannot write .*No such file or directory/],
    [['--flights', '--format', 'parquet'], /--format: Debian 12 and 13 have no library that writes Parquet .*to_polars\(\)\.write_parquet/],
    [['--flights', '--trial', '2'], /no such flight/],
    [['--flights', '--condition', 'x'], /--condition x: there is no such condition; use one of/],
    [['--flights', '--agents', 'random-walk'], /random-walk/],
    [['--format', 'mcap', '--out', join(out, 'x.mcap')], /cannot write .*No such file or directory/],
  ];
  for (const [given, message] of cases) {
    const {status, stderr, stdout} = run('export', results, ...given);
    assert.equal(status, 2, given.join(' '));
    assert.match(stderr, message);
    assert.equal(stdout, '');
  }
  const training = [
    [['--flights'], /a file; --format csv is of the result folders of 'aloft run'/],
    [['--format', 'tensorboard', '--out', out, '--trial', '0'], /the log of a training has none of them/],
    [['--format', 'tensorboard', '--out', out], /experiment.json:1: this is no line of a validation log of 'aloft train'/],
  ];
  for (const [given, message] of training) {
    const {status, stderr} = run('export', experiment, ...given);
    assert.equal(status, 2, given.join(' '));
    assert.match(stderr, message);
  }
  const long = join(scratch, 'long.log');
  writeFileSync(long, 'a'.repeat(1e6));
  assert.equal(run('export', long, '--format', 'tensorboard', '--out', out).status, 2);
  assert.deepEqual(readdirSync(scratch).filter((name) => name.startsWith('refused')), []);
});
