// How long robots wait for their answers while people watch, while the server
// keeps contacts, and while hostile programs besiege the console. Prints a
// Markdown table. Each way is measured by turns with a server that is left
// alone, so that both have the same machine.

import { join } from 'node:path';

import { hostileCases, randomOf } from './hostile.mjs';
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
  const end = Date.now() + 1000 * SECONDS;
  await beside({ programs, socket, address, end });
  const report = await robots;
  await programs.stopAll();
  return report;
}

const nothing = async () => {};
// Each looks at one robot.
const watchers = async ({ programs, socket }) => {
  await new Promise((resolve) => setTimeout(resolve, 1000));
  for (let stream = 1; stream <= 5; ++stream) {
    programs
      .start(
        'trainctl',
        'streams',
        'watch',
        String(stream),
        '--json',
        `--server=unix:${socket}`,
      )
      .stdout.resume();
  }
};
const hostile = async ({ address, end }) => {
  while (Date.now() < end - 2000) {
    for (const run of Object.values(hostileCases)) {
      if (Date.now() < end - 2000) await run(address, 1, randomOf(1));
    }
  }
};
const WAYS = {
  '5 watchers': [[], watchers],
  'contacts kept': [['--data-dir=@/data', '--keep-contacts=256M'], nothing],
  'hostile programs at the console': [[], hostile],
};

const middle = (values) =>
  [...values].sort((a, b) => a - b)[values.length >> 1];
console.log(
  `${ROBOTS} robots, 100 Hz, 4 frames a message, ${SECONDS} s; ` +
    `medians of ${TURNS} turns\n`,
);
console.log(
  '| beside the robots | p50 | p99 | alone: p50 | p99 | p99, times | lost |',
);
console.log('|---|---|---|---|---|---|---|');
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
  const lost = turns.reduce((sum, turn) => sum + turn.with.lost, 0);
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
      lost,
    ].join(' | ')} |`,
  );
}
