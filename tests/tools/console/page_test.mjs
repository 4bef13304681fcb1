// What people see and do on the console's page.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { test } from 'node:test';

import { browserOf } from './browser.mjs';
import { Programs } from './programs.mjs';

const AXE = readFileSync(
  createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const WIDTHS = [1440, 1024, 768];
const HOSTILE = '"><img src=x onerror=window.hacked=1>';
const programs = new Programs();
const browser = await browserOf(programs);

// A page that fails the test if it asks another host, breaks its policy or
// throws.
async function open(address, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const faults = [];
  page.on('request', (request) => {
    const { protocol, host } = new URL(request.url());
    const own = host === new URL(address).host;
    if (!own && !['data:', 'blob:'].includes(protocol)) {
      faults.push(`asks ${request.url()}`);
    }
  });
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.text().includes('Content Security Policy')) {
      faults.push(message.text());
    }
  });
  await page.goto(address);
  return { page, faults, close: () => context.close() };
}

// Waits until `look` is true in the page. (What playwright has for this is
// against the page's policy.)
async function until(page, look, value) {
  for (let i = 0; i < 300; ++i) {
    if (await page.evaluate(look, value)) return;
    await page.waitForTimeout(100);
  }
  assert.fail(`not within 30 s: ${look}`);
}

const count = (page, wanted) => until(page, (n) =>
  document.querySelectorAll('[data-robot]').length === n, wanted);

// No serious finding of axe, and no horizontal scroll, in all widths and both
// schemes. Pictures stay in the work folder.
async function inspect(page, name) {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    for (const width of WIDTHS) {
      await page.setViewportSize({ width, height: 900 });
      await page.screenshot({ path: `${name}-${width}-${colorScheme}.png` });
      const over = await page.evaluate(() =>
        document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(over <= 0, `${name} at ${width} px scrolls by ${over} px`);
    }
    // The page's policy forbids added scripts, but not evaluation from here.
    await page.evaluate(AXE);
    const found = await page.evaluate(async () => {
      const result = await window.axe.run(document);
      return result.violations
        .filter((violation) =>
          ['serious', 'critical'].includes(violation.impact))
        .map((violation) => `${violation.id}: ${violation.nodes[0].html}`);
    });
    assert.deepEqual(found, [], `${name}, ${colorScheme}`);
  }
  await page.emulateMedia({ colorScheme: 'light' });
  await page.setViewportSize({ width: 1440, height: 900 });
}

test('robots appear, are seen in full, end and come back', async () => {
  const socket = join(programs.folder, 'a.sock');
  const server = await programs.server(socket);
  const address = await programs.console(socket);
  const { page, faults, close } = await open(address);

  await page.getByText('No robot is streaming').waitFor({ timeout: 30_000 });
  await inspect(page, 'empty');

  const arms = ['arm-1', 'arm-2', HOSTILE].map((name, i) =>
    programs.robot(socket, name, `--seed=${i + 1}`));
  programs.robot(socket, 'two', '--objects=2', '--events', '--seed=7');
  await count(page, 4);
  assert.equal(await page.locator('[data-robot="arm-1"]').count(), 1);
  const names = await page.locator('.tile h2').allTextContents();
  assert.ok(names.includes(HOSTILE), names.join());
  await until(page, () => window.tactus.framesDrawn > 200);
  await page.getByText(/^contact \d+, /).first().waitFor({ timeout: 30_000 });
  await inspect(page, 'live');

  // All by keyboard.
  await page.locator('[data-robot="arm-2"] a').focus();
  await page.keyboard.press('Enter');
  await page.getByRole('heading', { name: 'arm-2' }).waitFor();
  await page.locator('.events li').first().waitFor({ timeout: 30_000 });
  await page.waitForTimeout(1500);
  await inspect(page, 'full');
  await page.locator('.back').focus();
  await page.keyboard.press('Space');
  await page.getByRole('button', { name: 'Go on' }).waitFor();
  const slider = page.getByRole('slider');
  const paused = Number(await slider.inputValue());
  assert.ok(paused > 10, `paused at ${paused}`);
  await page.keyboard.press('ArrowLeft');
  assert.equal(Number(await slider.inputValue()), paused - 1);
  await page.locator('.full .skin').focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowRight');
  await page.getByText(/^taxel 1 \(row 0, column 1\): .* N$/).waitFor();
  await page.keyboard.press('Space');
  await page.getByRole('button', { name: 'Pause' }).waitFor();
  await page.keyboard.press('Escape');
  await count(page, 4);

  await programs.stop(arms[0]);
  await page.locator('[data-robot="arm-1"]').getByText('ended').waitFor();

  await programs.stop(server);
  await page.getByText(/: connecting/).waitFor({ timeout: 30_000 });
  await inspect(page, 'offline');
  await programs.server(socket);
  programs.robot(socket, 'arm-9');
  await page.locator('[data-robot="arm-9"]').waitFor({ timeout: 30_000 });
  await until(page, () => document.getElementById('notice').hidden);

  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.deepEqual(faults, []);
  await close();
});

test('twenty robots are drawn at once', async () => {
  const socket = join(programs.folder, 'b.sock');
  await programs.server(socket);
  for (let i = 1; i <= 20; ++i) {
    programs.robot(socket, `arm-${i}`, `--seed=${i}`);
  }
  const address = await programs.console(socket);
  const { page, faults, close } = await open(address);
  await count(page, 20);
  const order = await page.locator('.tile h2').allTextContents();
  assert.deepEqual(order, [...order.keys()].map((i) => `arm-${i + 1}`));
  const begin = await page.evaluate(() => window.tactus.framesDrawn);
  await page.waitForTimeout(5000);
  const seen = await page.evaluate(() => {
    const delays = [...window.tactus.delays].sort((a, b) => a - b);
    const at = (part) => delays[Math.floor(part * (delays.length - 1))];
    return { drawn: window.tactus.framesDrawn, p50: at(0.5), p99: at(0.99) };
  });
  console.log(`20 robots: ${((seen.drawn - begin) / 100).toFixed(1)} frames/s ` +
    `each; from the server to the screen p50 ${seen.p50.toFixed(1)} ms, ` +
    `p99 ${seen.p99.toFixed(1)} ms`);
  assert.ok(seen.drawn > begin);
  await inspect(page, 'twenty');
  assert.deepEqual(faults, []);
  await close();
});

test('people sign in with their tokens', async () => {
  const socket = join(programs.folder, 'c.sock');
  const tokens = join(programs.folder, 'tokens');
  const maker = programs.start('trainctl', 'tokens', 'create', '--name=ann',
    '--role=viewer', `--file=${tokens}`);
  const [token] = await programs.line(maker, /^\S+$/);
  await programs.server(socket, `--tokens=${tokens}`);
  const address = await programs.console(socket);
  const { page, faults, close } = await open(address);

  const input = page.getByLabel('Token');
  await input.waitFor({ timeout: 30_000 });
  await inspect(page, 'sign-in');
  await input.fill('wrong');
  await page.keyboard.press('Enter');
  await page.getByRole('alert').filter({ hasText: /token/ }).waitFor();
  await input.fill(token);
  await page.keyboard.press('Enter');
  await page.getByText('No robot is streaming').waitFor({ timeout: 30_000 });

  const [cookie] = await page.context().cookies();
  assert.equal(cookie.httpOnly, true);
  assert.equal(cookie.sameSite, 'Strict');
  assert.equal(await page.evaluate(() => document.cookie), '');

  // Two windows of one person: both end with the sign-in.
  const second = await page.context().newPage();
  await second.goto(address);
  await second.getByText('No robot is streaming').waitFor();
  await page.getByRole('button', { name: 'Sign out' }).click();
  await input.waitFor();
  await second.getByLabel('Token').waitFor({ timeout: 30_000 });
  assert.deepEqual(faults, []);
  await close();
});
