// How long frames take from the server to the screen, and what that costs.
// Prints a Markdown table. BENCH_ROBOTS=1,4,20 says how many robots a row has,
// BENCH_SECONDS=60 how long they are watched.

import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

import { chromium } from 'playwright-core';

import { optionsOf } from './browser.mjs';
import { Programs } from './programs.mjs';

const SECONDS = Number(process.env.BENCH_SECONDS ?? 60);
const ROBOTS = (process.env.BENCH_ROBOTS ?? '1,4,20').split(',').map(Number);
const TICKS_PER_S = 100;

const stat = (pid) => {
  const text = readFileSync(`/proc/${pid}/stat`, 'utf8');
  return text.slice(text.lastIndexOf(')') + 2).split(' ');
};
const cpuSeconds = (pid) => {
  const fields = stat(pid);
  return (Number(fields[11]) + Number(fields[12])) / TICKS_PER_S;
};
const memoryMb = (pid) => Number(/VmHWM:\s+(\d+)/.exec(
  readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;

// The process and all below it.
function family(pid) {
  const parents = readdirSync('/proc').filter((name) => /^\d+$/.test(name))
    .map((name) => {
      try {
        return [Number(name), Number(stat(name)[1])];
      } catch {
        return [0, 0];   // it has ended
      }
    });
  const found = [pid];
  for (const parent of found) {
    found.push(...parents.filter(([, of]) => of === parent)
      .map(([child]) => child));
  }
  return found;
}
const cpuOf = (pids) => pids.reduce((sum, pid) => {
  try {
    return sum + cpuSeconds(pid);
  } catch {
    return sum;
  }
}, 0);

// One row of the table.
async function measure(robots) {
  const programs = new Programs();
  const socket = join(programs.folder, 'bench.sock');
  await programs.server(socket);
  const load = programs.start('tactus-load', `--server=unix:${socket}`,
    `--robots=${robots}`, `--seconds=${SECONDS + 60}`, '--rate=100');
  load.stdout.resume();
  const address = await programs.console(socket);
  const console_ = [...programs.running].at(-1);
  const server = await chromium.launchServer(optionsOf());
  const browser = await chromium.connect(server.wsEndpoint());
  const page = await browser.newPage({
    viewport: { width: 1440, height: 2700 } });
  await page.goto(address);
  while (await page.locator('[data-robot]').count() < robots) {
    await page.waitForTimeout(100);
  }
  await page.waitForTimeout(3000);
  const pids = family(server.process().pid);
  const begin = {
    browser: cpuOf(pids), console: cpuSeconds(console_.pid),
    drawn: await page.evaluate(() => window.tactus.framesDrawn),
  };
  await page.waitForTimeout(1000 * SECONDS);
  const seen = await page.evaluate(() => {
    const delays = [...window.tactus.delays].sort((a, b) => a - b);
    const at = (part) => delays[Math.floor(part * (delays.length - 1))];
    return { drawn: window.tactus.framesDrawn, p50: at(0.5), p99: at(0.99) };
  });
  const consoleCpu = cpuSeconds(console_.pid) - begin.console;
  const cells = [robots,
    ((seen.drawn - begin.drawn) / SECONDS / robots).toFixed(1),
    `${seen.p50.toFixed(0)} ms`, `${seen.p99.toFixed(0)} ms`,
    `${(100 * (cpuOf(pids) - begin.browser) / SECONDS).toFixed(0)} %`,
    `${(100 * consoleCpu / SECONDS).toFixed(1)} %`,
    `${memoryMb(console_.pid).toFixed(0)} MB`];
  await browser.close();
  await server.close();
  await programs.stopAll();
  return `| ${cells.join(' | ')} |`;
}

console.log('| robots | frames/s drawn of each | delay p50 | p99 ' +
  '| browser CPU | console CPU | console peak memory |');
console.log('|---|---|---|---|---|---|---|');
for (const robots of ROBOTS) console.log(await measure(robots));
