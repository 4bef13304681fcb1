// Hostile programs cannot stop the console, nor fill its memory, nor take an
// answer from a robot.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';

import { hostileCases, randomOf } from './hostile.mjs';
import { Programs } from './programs.mjs';

const SECONDS = Number(process.env.HOSTILE_SECONDS ?? 0.5);
const SEED = Number(process.env.HOSTILE_SEED ?? 1);
// Of the console beside what it has at rest: 512 connections with their
// buffers, which are below 32 KiB each, and what the allocator keeps.
const MOST_MB = 48;
const programs = new Programs();
after(() => programs.stopAll());

const memoryMb = (pid, field = 'VmRSS') =>
  Number(
    new RegExp(`${field}:\\s+(\\d+)`).exec(
      readFileSync(`/proc/${pid}/status`, 'utf8'),
    )[1],
  ) / 1024;

test(`a console answers people after each of them, seed ${SEED}`, async () => {
  const socket = join(programs.folder, 's.sock');
  await programs.server(socket);
  const trials = Math.ceil(4 * SECONDS);
  const robot = programs.start(
    'tactus-stream',
    `--server=unix:${socket}`,
    '--driver=sim',
    '--rate=real',
    `--trials=${trials}`,
    '--json',
  );
  let report = '';
  robot.stdout.on('data', (data) => {
    report += data;
  });
  const ended = new Promise((resolve) => robot.once('close', resolve));
  const address = new URL(await programs.console(socket));
  const console_ = programs.consoles.at(-1);
  const isThere = async () => {
    const response = await fetch(new URL('/api/session', address));
    return response.ok && (await response.json()).signed_in;
  };
  assert.ok(await isThere());
  const atRest = memoryMb(console_.pid);
  for (const [name, run] of Object.entries(hostileCases)) {
    const count = await run(address, SECONDS, randomOf(SEED));
    assert.ok(count > 0, name);
    assert.equal(console_.exitCode, null, name);
    assert.ok(await isThere(), name);
    const peak = memoryMb(console_.pid, 'VmHWM');
    console.log(
      `${name}: ${count} connections, peak so far ${peak.toFixed(0)} MB`,
    );
    assert.ok(
      peak < atRest + MOST_MB,
      `${name}: ${peak} MB, ${atRest} at rest`,
    );
  }
  await ended;
  const { trials: answered, lost } = JSON.parse(report);
  assert.deepEqual({ answered, lost }, { answered: trials, lost: 0 });
});
