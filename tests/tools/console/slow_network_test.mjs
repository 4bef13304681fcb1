// On a slow line a page shows fewer frames, and never old ones: nothing waits
// between a robot and the screen.

import assert from 'node:assert/strict';
import { createServer, connect } from 'node:net';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';

import { browserOf } from './browser.mjs';
import { Programs } from './programs.mjs';

// A robot's frames would need some five times as much.
const BYTES_PER_S = 20_000;
const ROBOTS = 2;
const SLOW_S = 12;
const programs = new Programs();
const browser = await browserOf(programs);

// Passes bytes on; once slow() is called, those to the browser at BYTES_PER_S.
async function line(address) {
  const { hostname, port } = new URL(address);
  let isSlow = false;
  const server = createServer((near) => {
    const far = connect(Number(port), hostname);
    near.pipe(far);
    near.on('error', () => far.destroy());
    far.on('error', () => near.destroy());
    far.on('end', () => near.end());
    far.on('data', async (bytes) => {
      far.pause();
      if (isSlow) await sleep((1000 * bytes.length) / BYTES_PER_S);
      near.write(bytes, () => far.resume());
    });
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    slow: () => {
      isSlow = true;
    },
    close: () => server.close(),
  };
}

test('a slow line loses frames, and delays none', async () => {
  const socket = join(programs.folder, 's.sock');
  await programs.server(socket);
  for (let i = 0; i < ROBOTS; ++i) programs.robot(socket, `arm-${i}`);
  const slowLine = await line(await programs.console(socket));
  const page = await browser.newPage();
  // How old messages are when the browser has them, in ms.
  let ages = [];
  page.on('websocket', (webSocket) =>
    webSocket.on('framereceived', ({ payload }) => {
      const json = payload.subarray(4, 4 + payload.readUInt32LE(0));
      ages.push(Date.now() - JSON.parse(json).console_time_ms);
    }),
  );
  await page.goto(slowLine.address);
  await page
    .locator('[data-robot]')
    .nth(ROBOTS - 1)
    .waitFor();
  await page.waitForTimeout(2000);
  const drawn = () => page.evaluate(() => window.tactus.framesDrawn);
  slowLine.slow();
  const before = await drawn();
  ages = [];
  await page.waitForTimeout(1000 * SLOW_S);
  const frames = (await drawn()) - before;
  const last = ages.slice(-8);
  console.log(
    `${frames} frames in ${SLOW_S} s; ages, in ms: ${last.join(' ')}`,
  );
  assert.ok(frames > ROBOTS, `${frames} frames`);
  assert.ok(frames < (30 * ROBOTS * SLOW_S) / 2, `${frames} frames: not slow`);
  // Had they waited, the last ones would be as old as most of the time.
  assert.ok(Math.max(...last) < (1000 * SLOW_S) / 4, last.join(' '));
  await page.close();
  slowLine.close();
});
