// How long robots wait for their answers while people watch, while the server
// keeps contacts, while its metrics are read, and while hostile programs besiege
// the console. Prints a Markdown table. Each way is measured by turns with a server that is left
// alone, so that both have the same machine. Watchers and hostile programs take
// the processor time that nobody else wants, as if they ran on other machines.

import { createServer } from 'node:net';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { Programs } from './programs.mjs';

const SECONDS = Number(process.env.BENCH_SECONDS ?? 20);
const ROBOTS = Number(process.env.BENCH_ROBOTS ?? 200);
const TURNS = Number(process.env.BENCH_TURNS ?? 3);

async function load(programs, socket, seed) {
  const program = programs.start(
    'tactus-load',
    `--server=unix:${socket}`,
    `--robots=${ROBOTS}`,
    '--rate=100',
    '--frames-per-message=4',
    '--cadence=every-message',
    `--seconds=${SECONDS}`,
    `--seed=${seed}`,
    '--json',
  );
  let text = '';
  program.stdout.on('data', (data) => {
    text += data;
  });
  await new Promise((resolve) => program.once('close', resolve));
  return JSON.parse(text);
}

// Runs `beside` while robots stream; returns what they saw.
async function measure(flags, beside, seed) {
  const programs = new Programs();
  const socket = join(programs.folder, 'b.sock');
  await programs.server(
    socket,
    ...flags.map((flag) => flag.replace('@', programs.folder)),
  );
  const address = new URL(await programs.console(socket));
  const robots = load(programs, socket, seed);
  const stop = await beside({ programs, socket, address });
  const report = await robots;
  stop?.();
  await programs.stopAll();
  return report;
}

const nothing = async () => {};
// Starts a program that runs when no other one does.
const startIdle = (programs, ...command) =>
  programs.start('/usr/bin/chrt', '--idle', '0', ...command).stdout.resume();
const trainctl = join(process.env.TACTUS_BIN, 'trainctl');
const siege = fileURLToPath(new URL('./siege.mjs', import.meta.url));

// Each looks at one robot.
const watchers = async ({ programs, socket }) => {
  await new Promise((resolve) => setTimeout(resolve, 1000));
  for (let stream = 1; stream <= 5; ++stream) {
    startIdle(
      programs,
      trainctl,
      'streams',
      'watch',
      String(stream),
      '--json',
      `--server=unix:${socket}`,
    );
  }
};
const hostile = async ({ programs, address }) => {
  startIdle(programs, process.execPath, siege, String(address));
};
// A port that nobody listens on.
const freePort = () =>
  new Promise((resolve) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
const metrics = `127.0.0.1:${await freePort()}`;
// As Prometheus does at its quickest usual pace.
const scrapes = async () => {
  const timer = setInterval(async () => {
    const response = await fetch(`http://${metrics}/metrics`);
    await response.text();
  }, 1000);
  return () => clearInterval(timer);
};
const WAYS = {
  '5 watchers': [[], watchers],
  'contacts kept': [['--data-dir=@/data', '--keep-contacts=256M'], nothing],
  'metrics read every second': [[`--metrics=${metrics}`], scrapes],
  'hostile programs at the console': [[], hostile],
};

const middle = (values) =>
  [...values].sort((a, b) => a - b)[values.length >> 1];
console.log(
  `${ROBOTS} robots, 100 Hz, 4 frames a message, ${SECONDS} s; ` +
    `medians of ${TURNS} turns\n`,
);
console.log(
  '| beside the robots | p50 | p99 | alone: p50 | p99 | p99, times ' +
    '| superseded | lost |',
);
console.log('|---|---|---|---|---|---|---|---|');
for (const [name, [flags, beside]] of Object.entries(WAYS)) {
  const turns = [];
  for (let turn = 1; turn <= TURNS; ++turn) {
    turns.push({
      with: await measure(flags, beside, turn),
      without: await measure([], nothing, turn),
    });
  }
  const of = (side, field) => middle(turns.map((turn) => turn[side][field]));
  const ms = (value) => `${value.toFixed(2)} ms`;
  const sum = (field) =>
    turns.reduce((total, turn) => total + turn.with[field], 0);
  const superseded = sum('superseded');
  console.log(
    `| ${[
      name,
      ms(of('with', 'p50_ms')),
      ms(of('with', 'p99_ms')),
      ms(of('without', 'p50_ms')),
      ms(of('without', 'p99_ms')),
      middle(
        turns.map((turn) => turn.with.p99_ms / turn.without.p99_ms),
      ).toFixed(2),
      superseded,
      // A message whose answer a newer one replaced has no answer of its own.
      Math.max(0, sum('lost') - superseded),
    ].join(' | ')} |`,
  );
}
