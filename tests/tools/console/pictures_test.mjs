// Draws each page with made-up answers, and compares the pictures with those in
// tests/golden/console (TACTUS_PICTURES). RECORD=1 replaces these. The pictures
// themselves stay in the folder "pictures".

import assert from 'node:assert/strict';
import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { launchBrowser } from './browser.mjs';
import { DEGRADED, NOW_MS, dataAnswers, serverAnswers, trainAnswers } from
  './fake_answers.mjs';
import { FakeConsole } from './fake_console.mjs';
import { makeRobots } from './fake_robot.mjs';
import { PictureComparison, differenceOf } from './picture_comparison.mjs';

const PAGE_DIR = join(process.env.TACTUS_BIN, '../share/tactus/console');
const KEPT = process.env.TACTUS_PICTURES;
const WIDTHS = [1440, 768];
const HEIGHT = 900;
const MOST_TRIES = 40;
// The fonts that chromium depends on; nothing moves.
const STYLE = `* { font-family: 'DejaVu Sans' !important;
  animation: none !important; transition: none !important;
  caret-color: transparent !important; }`;
const FRAMES = 45;
let browser;
let comparison;

before(async () => {
  browser = await launchBrowser(['--font-render-hinting=none']);
  comparison = await PictureComparison.make(browser);
  await mkdir('pictures', { recursive: true });
});
after(() => browser.close());

// `where`: the address; `until`: a text that is there when all is. Robots stand
// still in their 45th frame.
async function show({ where, until, answers = {}, robots = 0, token }) {
  const fake = new FakeConsole(PAGE_DIR, makeRobots(robots),
    token ? { token } : {});
  for (const robot of fake.robots) {
    for (let i = 0; i < FRAMES; ++i) robot.step();
    robot.isStill = true;
  }
  Object.assign(fake.answers, answers);
  const url = await fake.listen();
  // The policy forbids the style; other tests see to it that it holds.
  const context = await browser.newContext({ bypassCSP: true, locale: 'en-US',
    timezoneId: 'UTC', reducedMotion: 'reduce', deviceScaleFactor: 1 });
  const page = await context.newPage();
  await page.clock.setFixedTime(NOW_MS);
  await page.goto(url + where);
  await page.addStyleTag({ content: STYLE });
  await page.getByText(until).first().waitFor({ timeout: 30_000 });
  return { page, close: async () => {
    await context.close();
    await fake.close();
  } };
}

// Tries until the picture is like the one that is kept: charts are drawn after
// texts, and the machine may be busy. Returns what differs in the end.
async function differenceAt(page, name) {
  let difference = '';
  for (let tries = 0; tries < MOST_TRIES; ++tries) {
    const png = await page.screenshot({ fullPage: true });
    const isBusy = await page.locator('[aria-busy]').count() > 0;
    difference = isBusy ? 'it loads' :
      await comparison.compare(png, join(KEPT, `${name}.png`));
    if (difference === '') {
      await writeFile(join('pictures', `${name}.png`), png);
      return '';
    }
    await writeFile(join('pictures', `${name}.png`), png);
    await page.waitForTimeout(250);
  }
  return difference;
}

async function record(page, name) {
  await page.waitForTimeout(1500);
  const png = await page.screenshot({ fullPage: true });
  await writeFile(join('pictures', `${name}.png`), png);
  await comparison.keep(png, join(KEPT, `${name}.png`));
}

async function examine(page, state) {
  const faults = [];
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme, reducedMotion: 'reduce' });
    for (const width of WIDTHS) {
      await page.setViewportSize({ width, height: HEIGHT });
      const name = `${state}-${width}-${colorScheme}`;
      if (process.env.RECORD) {
        await record(page, name);
        continue;
      }
      const difference = await differenceAt(page, name);
      if (difference !== '') faults.push(`${name}: ${difference}`);
    }
  }
  assert.deepEqual(faults, [], 'RECORD=1 page_test.sh BIN WORK ' +
    'pictures_test.mjs keeps the new pictures, if they are as they should be');
}

const STATES = {
  live: { where: '', robots: 4, until: '12 frames lost' },
  'sign-in': { where: '', token: 'right', until: 'Token' },
  contacts: { where: '#contacts', answers: dataAnswers(),
    until: '4 of 4 kept contacts' },
  data: { where: '#data', answers: dataAnswers(), until: 'the left arm' },
  dataset: { where: '#data/arm/3', answers: dataAnswers(),
    until: 'run-11.csv' },
  train: { where: '#train', answers: trainAnswers(), until: 'k-fold' },
  job: { where: '#train/job/8', answers: trainAnswers(),
    until: 'Nothing was written.' },
  model: { where: '#train/model/arm/2', answers: trainAnswers(),
    until: 'Accuracy of mobility' },
  promotion: { where: '#train/job/9', answers: trainAnswers(),
    until: 'The gate was passed' },
  server: { where: '#server', answers: serverAnswers(),
    until: 'datasets/arm/versions/3' },
  'server-degraded': { where: '#server', until: 'datasets/arm/versions/3',
    answers: serverAnswers({ changes: DEGRADED }) },
};

for (const [name, state] of Object.entries(STATES)) {
  test(`the picture of ${name}`, async () => {
    const { page, close } = await show(state);
    try {
      await examine(page, name);
      const alerts = await page.locator('[role=alert]').allTextContents();
      assert.equal(alerts.join(''), '');
    } finally {
      await close();
    }
  });
}

// What people would see is found; what they would not, is not.
test('the comparison can fail', async () => {
  const { page, close } = await show(STATES.model);
  try {
    await seeChanges(page);
  } finally {
    await close();
  }
});

async function seeChanges(page) {
  await page.setViewportSize({ width: WIDTHS[0], height: HEIGHT });
  const name = `model-${WIDTHS[0]}-light`;
  await page.emulateMedia({ colorScheme: 'light' });
  assert.equal(await differenceAt(page, name), '');
  const changed = async (content) => {
    const style = await page.addStyleTag({ content });
    const difference = await comparison.compare(
      await page.screenshot({ fullPage: true }), join(KEPT, `${name}.png`));
    await style.evaluate((node) => node.remove());
    return difference;
  };
  assert.match(await changed('.drawing:last-child svg { visibility: hidden; }'),
    /squares differ/);
  assert.match(await changed('.confusion .right { --tone: transparent; }'),
    /squares differ/);
  assert.match(await changed('.card { background: #eee; }'), /squares differ/);
  assert.match(await changed('.pairs { display: none; }'),
    /squares/);
  assert.equal(await changed('body { position: relative; top: 3px; }'), '');
  assert.equal(await changed('* { -webkit-font-smoothing: none; ' +
    'letter-spacing: 0.1px; }'), '');
}

test('squares are compared with those beside them', () => {
  const of = (values) => ({ width: 20, height: 20, values });
  const flat = new Array(400).fill(100);
  const spot = (...places) => flat.map((value, i) =>
    places.includes(i) ? 200 : value);
  assert.equal(differenceOf(of(flat), of(flat.map((v) => v + 10))), '');
  assert.notEqual(differenceOf(of(flat), of(flat.map((v) => v + 11))), '');
  assert.equal(differenceOf(of(spot(40, 41)), of(flat)), '');
  assert.notEqual(differenceOf(of(spot(40, 41, 42)), of(flat)), '');
  assert.notEqual(differenceOf(of(flat), of(spot(40, 41, 42))), '');
  assert.equal(differenceOf(of(spot(84, 85, 86)), of(spot(105, 106, 107))), '');
  assert.notEqual(differenceOf(of(flat),
    { width: 20, height: 22, values: new Array(440).fill(100) }), '');
});
