// A newcomer's walk through the console that deploy/console.sh starts: a touch
// that is seen live, an answer that is corrected, a training with that label,
// and its model behind the alias's gate. Only clicks and keys of the browser do
// something; it prints how many there were, and how long it took.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';

import { browserOf } from './browser.mjs';
import { ContactsPage } from './contacts_page.mjs';
import { Programs } from './programs.mjs';

const MOST_CLICKS = 25;
const programs = new Programs();
const browser = await browserOf(programs);

// Hands that count.
class Walker {
  clicks = 0;
  keys = 0;

  constructor(page) { this.page = page; }

  async click(role, name) {
    ++this.clicks;
    await this.page.getByRole(role, { name, exact: true }).first().click();
  }

  async key(name) {
    ++this.keys;
    await this.page.keyboard.press(name);
  }

  async type(text) {
    this.keys += text.length;
    await this.page.keyboard.type(text);
  }
}

const startDemo = async () => {
  const demo = programs.start(join(process.env.TACTUS_DEPLOY, 'console.sh'),
    `--bin=${process.env.TACTUS_BIN}`, '--port=0', '--robots=2');
  return (await programs.line(demo, /^console: (http\S+)$/))[1];
};

// Gives the newest contact another class than was answered; it becomes a trial
// of the dataset.
async function correctOne(page, walker) {
  await walker.click('link', 'Contacts');
  assert.ok(await page.untilRows((rows) => rows.length > 0));
  await page.see('4', '.classes kbd');
  const [{ number, answered }] = await page.rows();
  const classes = await page.classes();
  assert.ok(classes.includes(answered), `${answered} of ${classes}`);
  await walker.key(String(classes.findIndex((name) => name !== answered) + 1));
  await page.see('1 label', '.count');
  assert.ok((await page.rows()).some((row) => row.number === number &&
    row.draft !== '' && row.draft !== answered));
  await walker.click('combobox', 'for');
  await walker.type('demo');
  await walker.key('Enter');
  await walker.click('button', 'Save');
  await page.see('Saved 1 label: this is demo@2 now.', '.told');
}

// What the dialog proposes is what was labelled.
async function train(page, walker) {
  await walker.click('link', 'Train');
  await walker.click('button', 'Train a model ...');
  const proposed = await page.page.getByLabel('Dataset version').inputValue();
  assert.equal(proposed, 'demo@2');
  await walker.click('button', 'Train');
  await page.untilJobDone();
  await page.see('demo@1', '.pairs');
}

// The built-in model has learned from many more trials than the demo has, so
// the gate lets a new one be somewhat worse.
async function setGate(page, walker) {
  await walker.click('link', 'Train');
  await walker.click('button', 'Promote ... default@1');
  await walker.click('button', 'Promote');
  await page.see('default names default@1 now.', '#told');
  await walker.click('button', 'Gate ... default');
  await page.page.locator('dialog').waitFor();
  assert.ok((await page.page.locator('dialog option').evaluateAll((options) =>
    options.map(({ value }) => value))).includes('held-out@1'), 'a proposal');
  await walker.type('held-out@1');
  for (const margin of ['0.2', '1', '0.2']) {
    await walker.key('Tab');
    await walker.type(margin);
  }
  await walker.key('Enter');
  await page.see('on held-out@1: accuracy');
}

async function promote(page, walker) {
  await walker.click('button', 'Promote ... demo@1');
  await walker.click('button', 'Promote');
  await page.untilJobDone();
  await page.see('The gate was passed');
  await walker.click('link', 'Train');
  await page.see('demo@1', 'tr:has([aria-label="Gate ... default"])');
}

test('a newcomer corrects an answer, trains, and promotes the model', async () => {
  const begun = performance.now();
  const page = await ContactsPage.open(browser, await startDemo());
  const walker = new Walker(page.page);
  // Without tokens nobody has to sign in.
  assert.equal(await page.page.getByLabel('Token').count(), 0);
  await page.see('arm-1', '[data-robot] h2');
  assert.ok(await page.until(() =>
    /contact \d+, /.test(document.body.innerText)), 'a touch is seen');
  await correctOne(page, walker);
  await train(page, walker);
  await setGate(page, walker);
  await promote(page, walker);
  await page.close();
  const minutes = (performance.now() - begun) / 60_000;
  console.log(`walk: ${walker.clicks} clicks, ${walker.keys} keys, ` +
    `${minutes.toFixed(1)} minutes`);
  assert.ok(walker.clicks <= MOST_CLICKS, `${walker.clicks} clicks`);
});
