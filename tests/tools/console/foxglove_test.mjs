// What Foxglove and Lichtblick get from a console, by their own client and
// their own schemas, with a real server and simulated robots.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';

import WebSocket from 'ws';

import { Programs } from './programs.mjs';

const require = createRequire(import.meta.url);
const { FoxgloveClient } = require('@foxglove/ws-protocol');
const { foxgloveEnumSchemas, foxgloveMessageSchemas, generateProto } =
  require('@foxglove/schemas/internal');
const protobuf = require('protobufjs');
const { FileDescriptorSet } = require('protobufjs/ext/descriptor');

const SCHEMAS = { skin: 'foxglove.RawImage', answer: 'tactus.v1.Answer',
  contacts: 'foxglove.ImageAnnotations', events: 'tactus.v1.WatchedEvent' };
const SIGNED_OUT = 4401;
const MOST_TRIES = 600;
const programs = new Programs();
let socket;
let address;

before(async () => {
  socket = join(programs.folder, 'foxglove.sock');
  await programs.server(socket);
  address = await programs.console(socket);
});
after(() => programs.stopAll());

async function until(what, condition) {
  for (let tries = 0; tries < MOST_TRIES; ++tries) {
    if (condition()) return;
    await sleep(50);
  }
  assert.fail(`${what}: never`);
}

const wsOf = (path, at = address) => at.replace(/^http/, 'ws') + path;

// The status of a console that refuses, or the protocol that it takes.
function attempt(url, protocols = FoxgloveClient.SUPPORTED_SUBPROTOCOL,
  options = {}) {
  const attempted = new WebSocket(url, protocols, options);
  return new Promise((resolve, reject) => {
    attempted.on('open', () => {
      resolve(attempted.protocol);
      attempted.close();
    });
    attempted.on('unexpected-response', (request, response) => {
      resolve(response.statusCode);
      response.resume();
    });
    attempted.on('error', reject);
  });
}

// A viewer that subscribes to everything and decodes all by the schemas that it
// is offered.
class Viewer {
  channels = new Map();
  // Topics of channels that have gone.
  gone = [];
  // By the topics: { time, data } of each message.
  messages = new Map();
  remarks = [];
  topics = new Map();
  errors = [];

  constructor(url, options = {}) {
    this.socket = new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL],
      options);
    this.client = new FoxgloveClient({ ws: this.socket });
    this.client.on('error', (error) => this.errors.push(error));
    this.client.on('serverInfo', (info) => { this.info = info; });
    this.client.on('status', (remark) => this.remarks.push(remark));
    this.client.on('close', (event) => { this.closed = event.code; });
    this.client.on('advertise', (channels) => {
      for (const channel of channels) this.add(channel);
    });
    this.client.on('unadvertise', (ids) => {
      for (const id of ids) {
        this.gone.push(this.channels.get(id).topic);
        this.channels.delete(id);
      }
    });
    this.client.on('message', ({ subscriptionId, timestamp, data }) => {
      const { topic, type } = this.topics.get(subscriptionId);
      const bytes = new Uint8Array(data.buffer, data.byteOffset,
        data.byteLength);
      this.messages.get(topic).push(
        { time: timestamp, data: plain(type, bytes) });
    });
  }

  add(channel) {
    assert.equal(channel.encoding, 'protobuf');
    this.channels.set(channel.id, channel);
    const type = typeOf(channel);
    this.messages.set(channel.topic, []);
    this.topics.set(this.client.subscribe(channel.id),
      { topic: channel.topic, type });
  }

  of(topic) { return this.messages.get(topic) ?? []; }
}

function typeOf(channel) {
  const root = protobuf.Root.fromDescriptor(
    FileDescriptorSet.decode(Buffer.from(channel.schema, 'base64')));
  root.resolveAll();
  return root.lookupType(channel.schemaName);
}

// The message as JSON of protobuf has it, but for bytes.
function plain(type, bytes) {
  return type.toObject(type.decode(bytes),
    { longs: String, enums: String, defaults: true });
}

// Without what is absent, which the two ways of JSON write differently.
function present(value) {
  if (Array.isArray(value)) return value.map(present);
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(Object.entries(value)
    .filter(([, item]) => item !== null && item !== undefined)
    .map(([key, item]) => [key, present(item)]).sort());
}

// What the console's own page gets of each frame, by its capture time.
class LivePage {
  frames = new Map();
  opened = new Map();

  constructor() {
    this.socket = new WebSocket(wsOf('api/live'),
      { origin: new URL(address).origin });
    this.socket.on('open', () => this.socket.send('next'));
    this.socket.on('message', (bytes) => {
      const length = bytes.readUInt32LE(0);
      const { updates } = JSON.parse(bytes.subarray(4, 4 + length));
      const taxels = new Float32Array(new Uint8Array(
        bytes.subarray(4 + length)).buffer);
      for (const { taxels: begin, update } of updates) {
        if (update.opened) this.opened.set(update.opened.client_id, update);
        if (update.frame) {
          this.frames.set(`${update.stream_id} ` +
            update.frame.answer.capture_time_ns,
          { answer: update.frame.answer, taxels: taxels.slice(begin) });
        }
      }
      this.socket.send('next');
    });
  }
}

// A message type of Foxglove's own, from what they publish.
function officialType(name) {
  const root = new protobuf.Root();
  root.resolvePath = () => null;
  const add = (schema) => {
    const enums = Object.values(foxgloveEnumSchemas).filter(
      ({ parentSchemaName }) => parentSchemaName === schema.name);
    protobuf.parse(generateProto(schema, enums), root, { keepCase: true });
    for (const { type } of schema.fields) {
      if (type.type === 'nested' &&
          !root.nested?.foxglove?.nested?.[type.schema.name]) {
        add(type.schema);
      }
    }
  };
  add(foxgloveMessageSchemas[name]);
  const time = protobuf.common.get('google/protobuf/timestamp.proto');
  root.addJSON(time.nested);
  root.resolveAll();
  return root.lookupType(`foxglove.${name}`);
}

// Fails if `ours` has a field that `official` has not, or has otherwise.
function checkAgainst(official, ours) {
  for (const field of ours.fieldsArray) {
    const other = official.fields[field.name];
    const where = `${ours.fullName}.${field.name}`;
    assert.ok(other, `${where} is not Foxglove's`);
    assert.equal(field.id, other.id, where);
    assert.equal(field.repeated, other.repeated, where);
    if (field.resolvedType instanceof protobuf.Type) {
      assert.equal(field.resolvedType.fullName, other.resolvedType.fullName);
      checkAgainst(other.resolvedType, field.resolvedType);
    } else if (field.resolvedType) {
      assert.deepEqual({ ...field.resolvedType.values },
        { ...other.resolvedType.values });
    } else {
      assert.equal(field.type, other.type, where);
    }
  }
}

const nsOf = ({ seconds, nanos }) =>
  String(BigInt(seconds) * 1_000_000_000n + BigInt(nanos));

test('a robot is seen as on the console\'s own page', async () => {
  const robot = programs.robot(socket, 'left arm', '--objects=2',
    '--events', '--seed=7');
  const viewer = new Viewer(wsOf('foxglove'));
  // The console has asked its server by now, as for a page.
  await until('greeting', () => viewer.info);
  const page = new LivePage();
  assert.match(viewer.info.name, /^tactus-console /);
  assert.deepEqual(viewer.info.capabilities, []);
  assert.equal(viewer.socket.protocol, 'foxglove.websocket.v1');
  await until('channels', () => viewer.channels.size === 4);
  const [first] = viewer.channels.values();
  assert.equal(first.topic, '/left_arm/skin');
  for (const channel of viewer.channels.values()) {
    const [, name] = /^\/left_arm\/(\w+)$/.exec(channel.topic);
    assert.equal(channel.schemaName, SCHEMAS[name]);
    if (name === 'skin' || name === 'contacts') {
      checkAgainst(officialType(channel.schemaName.replace('foxglove.', '')),
        typeOf(channel));
    }
  }

  const stream = () => page.opened.get('left arm');
  const liveOf = (captureNs) =>
    page.frames.get(`${stream()?.stream_id} ${captureNs}`);
  const answers = () => viewer.of('/left_arm/answer').map(({ data }) => data);
  const both = () => answers().filter(({ capture_time_ns: time }) =>
    liveOf(time));
  const decided = () => both().filter(({ contacts }) => contacts.some(
    ({ patch, answers: all }) => patch && all.some(
      ({ decision }) => decision)));
  await until('answers to both, with a decision', () =>
    both().length > 20 && decided().length > 5);
  await until('an event', () => viewer.of('/left_arm/events').length > 1);

  for (const answer of both()) {
    assert.deepEqual(present(answer),
      present(liveOf(answer.capture_time_ns).answer));
  }
  const { geometry, questions } = stream().opened.started;
  let compared = 0;
  for (const { data: image } of viewer.of('/left_arm/skin')) {
    assert.equal(image.encoding, '32FC1');
    assert.equal(image.width, geometry.columns);
    assert.equal(image.height, geometry.rows);
    assert.equal(image.step, 4 * geometry.columns);
    assert.equal(image.data.length, image.step * image.height);
    assert.equal(image.frame_id, geometry.layout);
    const live = liveOf(nsOf(image.timestamp));
    if (!live) continue;
    ++compared;
    const pixels = new Float32Array(new Uint8Array(image.data).buffer);
    const half = 4 * geometry.onset_threshold;
    pixels.forEach((pixel, i) => assert.ok(
      Math.abs(pixel - live.taxels[i] / (live.taxels[i] + half)) < 1e-6,
      `pixel ${i} is ${pixel} at ${live.taxels[i]}`));
  }
  assert.ok(compared > 0, 'no picture of a frame that the page has');

  // One outline and one text for each contact that is felt.
  let outlined = 0;
  for (const { data } of viewer.of('/left_arm/contacts')) {
    const live = liveOf(nsOf(data.timestamp));
    if (!live) continue;
    const felt = live.answer.contacts.filter(
      ({ patch }) => patch?.taxels.length > 0);
    assert.equal(data.points.length, felt.length);
    assert.deepEqual(data.texts.map(({ text }) => text),
      felt.map((contact) => textOf(contact, questions)));
    for (const { type, points } of data.points) {
      assert.equal(type, 'LINE_LIST');
      assert.equal(points.length % 2, 0);
      ++outlined;
    }
  }
  assert.ok(outlined > 0, 'no outline');

  // Times are those of the console's clock, and rise.
  for (const topic of viewer.messages.keys()) {
    const times = viewer.of(topic).map(({ time }) => time);
    assert.ok(times.every((time, i) => i === 0 || time >= times[i - 1]), topic);
    assert.ok(Math.abs(Number(times.at(-1) / 1_000_000n) - Date.now()) <
      60_000);
  }
  const kinds = viewer.of('/left_arm/events').map(({ data }) =>
    data.event.kind);
  assert.ok(kinds.every((kind) => /^KIND_[A-Z]/.test(kind)), kinds.join());

  // Somebody of the same name.
  const other = programs.robot(socket, 'left arm');
  await until('another robot', () => viewer.channels.size === 8);
  const topics = [...viewer.channels.values()].map(({ topic }) => topic);
  assert.equal(new Set(topics).size, 8);
  await programs.stop(other);
  await until('its end', () => viewer.channels.size === 4);
  await programs.stop(robot);
  await until('the end', () => viewer.channels.size === 0);
  assert.deepEqual(viewer.gone.slice(-4),
    Object.keys(SCHEMAS).map((name) => `/left_arm/${name}`));
  assert.deepEqual(viewer.errors, []);
  assert.deepEqual(viewer.remarks, []);
  page.socket.close();
  viewer.client.close();
});

function textOf({ id, unknown, answers }, questions) {
  if (unknown > 0.5) return `${id}: unknown`;
  const words = answers.flatMap(({ decision }, q) =>
    decision ? [questions[q].values[decision.value]] : []);
  return words.length === 0 ? id : `${id}: ${words.join(', ')}`;
}

test('what it does not know, and what is no message', async () => {
  const viewer = new Viewer(wsOf('foxglove'));
  await until('greeting', () => viewer.info);
  viewer.client.getParameters(['a'], 'b');
  viewer.client.sendMessage(1, new Uint8Array(10));
  viewer.client.unsubscribe(77);
  viewer.client.subscribe(1_000_000);
  await until('remarks', () => viewer.remarks.length === 3);
  assert.match(viewer.remarks[0].message, /getParameters/);
  assert.equal(viewer.closed, undefined);
  viewer.socket.send('{"op":');
  await until('the end', () => viewer.closed);
  assert.equal(viewer.closed, 1008);
  const talker = new Viewer(wsOf('foxglove'));
  await until('greeting', () => talker.info);
  talker.socket.send(JSON.stringify({ op: 'x'.repeat(20_000) }));
  await until('the end', () => talker.closed);
  assert.equal(talker.closed, 1009);
});

test('the newer protocol is preferred, and one is needed', async () => {
  const url = wsOf('foxglove');
  assert.equal(await attempt(url, ['foxglove.sdk.v1']), 'foxglove.sdk.v1');
  assert.equal(await attempt(url,
    ['foxglove.websocket.v1', 'foxglove.sdk.v1']), 'foxglove.sdk.v1');
  assert.equal(await attempt(url, ['foxglove.other']), 400);
});

// Foxglove in a browser comes from another site.
test('a key lets pages of others watch until the sign-out', async () => {
  const own = join(programs.folder, 'tokens.sock');
  const tokens = join(programs.folder, 'tokens');
  const maker = programs.start('trainctl', 'tokens', 'create', '--name=ann',
    '--role=viewer', `--file=${tokens}`);
  const [token] = await programs.line(maker, /^\S+$/);
  await programs.server(own, `--tokens=${tokens}`);
  const at = await programs.console(own);
  const { origin } = new URL(at);
  const stranger = { origin: 'https://app.example' };
  const url = wsOf('foxglove', at);
  assert.equal(await attempt(url), 403);
  assert.equal(await attempt(url, undefined, { origin }), 403);
  const signedIn = await fetch(`${at}api/sign-in`, { method: 'POST',
    headers: { Origin: origin }, body: JSON.stringify({ token }) });
  assert.equal(signedIn.status, 200);
  const { watch_key: key, csrf } = await signedIn.json();
  const cookie = signedIn.headers.get('set-cookie').split(';')[0];
  assert.equal(await attempt(url, undefined, stranger), 403);
  assert.equal(await attempt(`${url}?key=${csrf}`, undefined, stranger), 403);
  const viewer = new Viewer(`${url}?key=${key}`, stranger);
  await until('greeting', () => viewer.info);
  const signedOut = await fetch(`${at}api/sign-out`, { method: 'POST',
    headers: { Origin: origin, Cookie: cookie, 'X-CSRF-Token': csrf } });
  assert.equal(signedOut.status, 204);
  await until('the end', () => viewer.closed);
  assert.equal(viewer.closed, SIGNED_OUT);
  assert.equal(await attempt(`${url}?key=${key}`, undefined, stranger), 403);
});
