// The loop that the contact log is for, by what people do in the console: a
// model that has never met a material answers its contacts, somebody labels the
// most uncertain ones, a new model learns from them, and makes fewer errors.
//
// All of it is simulated, so that the truth is known. Held-out contacts are
// those of arms of other stiffnesses than the arms whose contacts are labelled.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';

import { browserOf } from './browser.mjs';
import { ContactsPage } from './contacts_page.mjs';
import { Programs } from './programs.mjs';

const MATERIAL = 'natural-rubber';
const LABELS = 60;
// Of --protocol=grid: its materials, arms, trials and seed.
const SETS = {
  others: { stiffness: [250, 630, 1600, 4000], sample: 160, seed: 1 },
  more: { stiffness: [250, 1600], sample: 30, seed: 2 },
  rubber: { stiffness: [250, 1600], sample: 100, seed: 3 },
  held: { stiffness: [630, 4000], sample: 100, seed: 4 },
  gate: { stiffness: [630, 4000], sample: 60, seed: 5 },
};
const OF_MATERIAL = ['rubber', 'held'];
const FRAMES = 600;
const programs = new Programs();
const at = (name) => join(programs.folder, name);
const browser = await browserOf(programs);

// Two tables of materials: the new one, and all others.
function writeMaterials() {
  const lines = readFileSync(process.env.TACTUS_MATERIALS, 'utf8').split('\n')
    .filter((line) => line !== '' && !line.startsWith('#'));
  const isNew = (line) => line.startsWith(`${MATERIAL},`);
  const [head, ...rows] = lines;
  writeFileSync(at('new.csv'), [head, ...rows.filter(isNew), ''].join('\n'));
  writeFileSync(at('known.csv'),
    [head, ...rows.filter((row) => !isNew(row)), ''].join('\n'));
}

const simulate = ([name, { stiffness, sample, seed }]) =>
  programs.run('trainctl', 'simulate', '--protocol=grid', '--skin=good',
    `--materials=${at(OF_MATERIAL.includes(name) ? 'new.csv' : 'known.csv')}`,
    '--stiffness', ...stiffness.map(String), `--sample=${sample}`,
    `--seed=${seed}`, `--out=${at(`${name}.h5`)}`);

async function output(name, ...flags) {
  const program = programs.start(name, ...flags);
  let text = '';
  program.stdout.on('data', (data) => { text += data; });
  await new Promise((resolve) => program.once('close', resolve));
  assert.equal(program.exitCode, 0, `${name} ${flags.join(' ')}`);
  return text;
}

// Streams all trials of a file as one robot, and counts what is right.
const stream = async (server, name, model = '') => JSON.parse(await output(
  'tactus-stream', server, '--driver=replay', `--data=${at(`${name}.h5`)}`,
  '--rate=max', `--client-id=${name}`, '--json',
  ...(model ? [`--model=${model}`] : [])));

// The labels of a file's trials, in their order.
async function labelsOf(server, name) {
  await output('trainctl', 'datasets', 'create', `only-${name}`, server);
  await output('trainctl', 'datasets', 'upload', `only-${name}`,
    `--data=${at(`${name}.h5`)}`, server);
  const { trials } = JSON.parse(await output('trainctl', 'datasets', 'show',
    `only-${name}`, '--trials', '--json', server));
  return trials.sort((a, b) => a.id < b.id ? -1 : 1)
    .map(({ label }) => label);
}

// At least so many contacts, once the log has written all of them.
async function logged(server, least) {
  let before = -1;
  for (let tries = 0; tries < 60; ++tries) {
    const { contacts } = JSON.parse(await output('trainctl', 'contacts', 'list',
      '--most=1000', '--json', server));
    if (contacts.length >= least && contacts.length === before) return contacts;
    before = contacts.length;
    await sleep(500);
  }
  return assert.fail(`the log has ${before} contacts of ${least}`);
}

// What each logged contact truly was, by its robot and its place there.
async function truthOf(server, names, least) {
  const labels = {};
  for (const name of names) labels[name] = await labelsOf(server, name);
  const contacts = await logged(server, least);
  return new Map(contacts.map(({ name, robot, onset_sequence }) =>
    [name.replace('contacts/', ''),
      labels[robot][Math.floor(onset_sequence / FRAMES)]]));
}

// By real keys: the digit of the true class, or Enter if the answer is true.
async function labelMostUncertain(page, truth) {
  await page.page.getByLabel('Order').selectOption('uncertain');
  assert.ok(await page.until(() => location.hash.includes('order=uncertain')));
  assert.ok(await page.untilRows((rows) => rows.length === 50 &&
    rows.every(({ percent }, i) => i === 0 || percent >= rows[i - 1].percent)));
  const classes = await page.classes();
  let confirmed = 0;
  await page.page.locator('[data-contact] .link').first().focus();
  for (let count = 1; count <= LABELS; ++count) {
    const number = await page.current();
    const label = truth.get(number);
    assert.ok(label, `contact ${number} is of no trial`);
    const { answered } = (await page.rows()).find((row) =>
      row.number === number);
    confirmed += Number(answered === label);
    await page.page.keyboard.press(answered === label ? 'Enter' :
      String(classes.indexOf(label) + 1));
    await page.see(count === 1 ? '1 label' : `${count} labels`, '.count');
    if (count === LABELS) break;
    assert.ok(await page.until((before) => {
      const row = document.activeElement.closest('[data-contact]');
      return row !== null && row.dataset.contact !== before;
    }, number));
  }
  return confirmed;
}

test('labels of uncertain contacts make a better model', async () => {
  writeMaterials();
  await Promise.all(Object.entries(SETS).map(simulate));
  const socket = at('s.sock');
  const server = `--server=unix:${socket}`;
  await programs.server(socket, `--data-dir=${at('data')}`,
    '--keep-contacts=128M');
  const trainctl = (...words) => programs.run('trainctl', ...words, server);
  for (const [dataset, name] of [['skin', 'others'], ['check', 'gate']]) {
    await trainctl('datasets', 'create', dataset);
    await trainctl('datasets', 'upload', dataset, `--data=${at(`${name}.h5`)}`);
  }
  await trainctl('train', '--dataset=skin', '--model=skin', '--preset=paper',
    '--networks=0', '--seed=1');
  await trainctl('models', 'promote', 'skin@1');
  const pool = ['rubber', 'more'];
  let felt = 0;
  for (const name of pool) felt += (await stream(server, name)).felt;
  const truth = await truthOf(server, pool, felt);

  const page = await ContactsPage.open(browser,
    `${await programs.console(socket)}#contacts`);
  await page.see('4', '.classes kbd');
  const confirmed = await labelMostUncertain(page, truth);
  await page.page.getByLabel('for', { exact: true }).selectOption('skin');
  await page.page.getByLabel('Reason').fill('a material that is new');
  await page.press('Save');
  await page.see(`Saved ${LABELS} labels: this is skin@2 now.`, '.told');

  await page.page.getByRole('link', { name: 'Train' }).click();
  await page.press('Train a model ...');
  await page.page.getByLabel('Dataset version').fill('skin@2');
  await page.page.getByLabel('Model', { exact: true }).fill('skin');
  await page.page.getByLabel('Preset').selectOption('paper');
  await page.page.getByLabel('LSTM networks').fill('0');
  await page.press('Train');
  await page.untilJobDone();

  // The new model has to be about as good on what was known before.
  await page.page.getByRole('link', { name: 'Train' }).click();
  await page.press('Gate ... default');
  await page.page.getByLabel('Dataset version').fill('check@1');
  for (const [name, margin] of [['Accuracy may be less by', '0.1'],
    ['Log-loss may be more by', '0.5'],
    ['Calibration error may be more by', '0.2']]) {
    await page.page.getByLabel(name).fill(margin);
  }
  await page.press('Set');
  await page.see('on check@1: accuracy');
  await page.press('Promote ... skin@2');
  await page.press('Promote');
  await page.untilJobDone();
  await page.page.getByRole('link', { name: 'Train' }).click();
  await page.see('skin@2', 'tr:has([aria-label="Gate ... default"])');
  await page.close();

  const former = await stream(server, 'held', 'models/skin/versions/1');
  const present = await stream(server, 'held');
  const row = (name, { wrong, felt }) => `  ${name.padEnd(8)} ${wrong} of ` +
    `${felt} wrong (${(100 * wrong / felt).toFixed(1)} %)`;
  console.log(['', `held-out contacts of ${MATERIAL}, on arms of other ` +
    'stiffnesses:', row('skin@1', former), row('skin@2', present),
  `  ${LABELS} labels, ${confirmed} of them confirmed; seeds ` +
    Object.entries(SETS).map(([name, { seed }]) => `${name} ${seed}`)
      .join(', ')].join('\n'));
  assert.equal(former.felt, present.felt);
  assert.ok(present.wrong < former.wrong, 'errors fall');
});
