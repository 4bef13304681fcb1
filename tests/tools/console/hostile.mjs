// What hostile programs do to a console: each case goes on for some time, with
// connections of its own. The same seed sends the same bytes.

import { connect } from 'node:net';
import { setTimeout as sleep } from 'node:timers/promises';

// Numbers below `n` (mulberry32).
export function randomOf(seed) {
  let state = seed >>> 0;
  return (n) => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) % n;
  };
}

const bytesOf = (random, n) => Buffer.from({ length: n }, () => random(256));

// A connection that takes and forgets whatever comes.
function open({ hostname, port }) {
  const socket = connect(Number(port), hostname);
  socket.on('error', () => {});
  socket.resume();
  return socket;
}
const gone = (socket) =>
  new Promise((resolve) => {
    if (socket.closed) resolve();
    socket.once('close', resolve);
  });

// Sends `bytes`, then waits for the other side, but not for long.
async function say(at, bytes) {
  const socket = open(at);
  socket.end(bytes);
  await Promise.race([gone(socket), sleep(500, undefined, { ref: false })]);
  socket.destroy();
}

// Calls `once` on `lanes` connections side by side until the time is over.
async function repeat(seconds, lanes, once) {
  const end = Date.now() + 1000 * seconds;
  let count = 0;
  await Promise.all(
    Array.from({ length: lanes }, async () => {
      while (Date.now() < end) {
        await once();
        ++count;
      }
    }),
  );
  return count;
}

// Keeps `count` connections open, and writes `bytes()` to each every second.
async function hold(at, seconds, count, first, bytes) {
  const sockets = [];
  for (let i = 0; i < count; ++i) {
    const socket = open(at);
    socket.write(first);
    sockets.push(socket);
    if (i % 50 === 49) await sleep(10);
  }
  const end = Date.now() + 1000 * seconds;
  do {
    for (const socket of sockets) {
      if (!socket.destroyed) socket.write(bytes());
    }
    await sleep(1000);
  } while (Date.now() < end);
  sockets.forEach((socket) => socket.destroy());
  return count;
}

const requestTo = (at, target, ...headers) =>
  Buffer.from(
    [`GET ${target} HTTP/1.1`, `Host: ${at.host}`, ...headers, '', ''].join(
      '\r\n',
    ),
  );
const webSocketTo = (at, target = '/api/live') =>
  requestTo(
    at,
    target,
    `Origin: http://${at.host}`,
    'Connection: Upgrade',
    'Upgrade: websocket',
    'Sec-WebSocket-Version: 13',
    'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==',
  );
const callTo = (at, body, length = body.length) =>
  Buffer.concat([
    Buffer.from(
      [
        'POST /api/servers/0/ModelService/ListModels HTTP/1.1',
        `Host: ${at.host}`,
        `Origin: http://${at.host}`,
        'X-CSRF-Token: 0',
        `Content-Length: ${length}`,
        '',
        '',
      ].join('\r\n'),
    ),
    body,
  ]);

// A good request in which some bytes are changed, left out or said again.
function damaged(random, good) {
  let bytes = Buffer.from(good);
  for (let i = 1 + random(6); i > 0; --i) {
    const at = random(bytes.length);
    const length = random(40);
    switch (random(4)) {
      case 0:
        bytes[at] = random(256);
        break;
      case 1:
        bytes = Buffer.concat([
          bytes.subarray(0, at),
          bytes.subarray(at + length),
        ]);
        break;
      case 2:
        bytes = Buffer.concat([
          bytes.subarray(0, at + length),
          bytes.subarray(at),
        ]);
        break;
      default:
        bytes = Buffer.concat([
          bytes.subarray(0, at),
          bytesOf(random, length),
          bytes.subarray(at),
        ]);
    }
    if (bytes.length === 0) return good;
  }
  return bytes;
}

const TARGETS = [
  '/../../etc/passwd',
  '/%2e%2e/%2e%2e/etc/passwd',
  '/app.js/../../main',
  '//etc/passwd',
  '/api/servers/0/../../session',
  '/api/servers/99999999999999999999/ModelService/ListModels',
  '/api/servers/-1/ModelService/ListModels',
  '/api/servers/0/ModelService/DeleteModel%00',
  '/\\..\\x',
  `/${'a'.repeat(7000)}`,
  '/api/live?x=1',
  '*',
  'http://elsewhere/',
];

// Masked frames of a WebSocket, as a browser sends them; the mask is zero.
function frame(first, payload, length = payload.length) {
  const head = Buffer.alloc(14);
  head[0] = first;
  head[1] = 0x80 | 127;
  head.writeBigUInt64BE(BigInt(length), 2);
  return Buffer.concat([head, payload]);
}
const TEXT = 0x81;
const PING = 0x89;
const FRAGMENT = 0x00;

// Opens a WebSocket of a page, says `bytes` again and again, and is left.
async function webSocketSays(at, bytes, times) {
  const socket = open(at);
  socket.write(webSocketTo(at));
  await sleep(20);
  for (let i = 0; i < times && !socket.destroyed; ++i) {
    if (!socket.write(bytes)) await sleep(5);
  }
  socket.end();
  await Promise.race([gone(socket), sleep(500, undefined, { ref: false })]);
  socket.destroy();
}

// name: (at, seconds, random) => how many connections there were.
export const hostileCases = {
  'any bytes': (at, seconds, random) =>
    repeat(seconds, 8, () => say(at, bytesOf(random, 1 + random(4000)))),
  'damaged requests': (at, seconds, random) => {
    const good = [
      requestTo(at, '/'),
      requestTo(at, '/api/session', 'Cookie: tactus=0'),
      webSocketTo(at),
      callTo(at, Buffer.from('{}')),
    ];
    return repeat(seconds, 8, () =>
      say(at, damaged(random, good[random(good.length)])),
    );
  },
  'paths to elsewhere': (at, seconds, random) =>
    repeat(seconds, 8, () =>
      say(at, requestTo(at, TARGETS[random(TARGETS.length)])),
    ),
  'headers without end': (at, seconds) =>
    repeat(seconds, 8, () =>
      say(
        at,
        Buffer.concat([
          requestTo(at, '/').subarray(0, -2),
          Buffer.alloc(200_000, 'a: b\r\n'),
        ]),
      ),
    ),
  'large bodies': (at, seconds) =>
    repeat(seconds, 8, () => say(at, callTo(at, Buffer.alloc(600_000, ' ')))),
  'bodies that do not come': (at, seconds) =>
    hold(at, seconds, 200, callTo(at, Buffer.alloc(0), 16_000), () => ' '),
  'a byte a second': (at, seconds) =>
    hold(at, seconds, 300, 'GET / HTTP/1.1\r\nX: ', () => 'x'),
  '1,000 connections': (at, seconds) => hold(at, seconds, 1000, '', () => ''),
  'requests without pause': (at, seconds) =>
    repeat(seconds, 16, () =>
      say(at, requestTo(at, '/app.js', 'Connection: close')),
    ),
  'floods of a WebSocket': (at, seconds) =>
    repeat(seconds, 4, () =>
      webSocketSays(at, frame(TEXT, Buffer.from('next')), 2000),
    ),
  'floods of pings': (at, seconds) =>
    repeat(seconds, 4, () =>
      webSocketSays(at, frame(PING, Buffer.alloc(100)), 2000),
    ),
  'messages too long': (at, seconds) =>
    repeat(seconds, 4, () =>
      webSocketSays(at, frame(TEXT, Buffer.alloc(100_000), 2 ** 40), 20),
    ),
  'fragments without end': (at, seconds) =>
    repeat(seconds, 4, () =>
      webSocketSays(at, frame(FRAGMENT, Buffer.from('n')), 200),
    ),
  'frames of any bytes': (at, seconds, random) =>
    repeat(seconds, 4, () => webSocketSays(at, bytesOf(random, 500), 4)),
};
