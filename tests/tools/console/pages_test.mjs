// What people see and do on the console's pages for data, training and the
// server, with a real server that keeps data and trains.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';

import { browserOf } from './browser.mjs';
import { BrowserPage } from './browser_page.mjs';
import { Programs } from './programs.mjs';

const HOSTILE = '"><img src=x onerror=window.hacked=1>';
const tally = { check: (condition, text) => assert.ok(condition, text) };
const programs = new Programs();
const browser = await browserOf(programs);
let trials;

before(async () => {
  trials = join(programs.folder, 'trials.h5');
  await programs.run('trainctl', 'simulate', '--protocol=grid', '--sample=60',
    '--seed=1', `--out=${trials}`);
});

// A server with a data directory, and a page of its console.
async function begin(name, ...flags) {
  const socket = join(programs.folder, `${name}.sock`);
  const server = await programs.server(socket,
    `--data-dir=${join(programs.folder, name)}`, ...flags);
  const address = await programs.console(socket);
  const trainctl = (...words) =>
    programs.run('trainctl', ...words, `--server=unix:${socket}`);
  return { socket, server, address, trainctl };
}

async function addData(trainctl, ...flags) {
  await trainctl('datasets', 'create', 'arm', ...flags);
  await trainctl('datasets', 'upload', 'arm', `--data=${trials}`);
}

const show = (address, where) =>
  BrowserPage.open(browser, address + where, tally, '.');

const see = async (page, text, selector) => assert.ok(
  await page.untilText(text, selector), `"${text}" is not there; but:\n` +
    await page.text());

// Pictures of what is in sight: those of whole pages take long.
const examine = (page, state, fullPage = false) =>
  page.examine(state, fullPage, 80);

const press = (page, name) =>
  page.page.getByRole('button', { name, exact: true }).click();

// Those of docs/console.md; the other one is train-model-1440-light.png.
async function drawPictures(page, socket, address, trainctl) {
  await trainctl('datasets', 'relabel', 'arm', '000504', '--label=SM',
    '--reason=it moved');
  await page.page.goto(`${address}#data/arm/2`);
  await see(page, '1 relabelled: it moved');
  await see(page, '000504');
  await page.page.screenshot({ path: 'picture-data.png' });
  for (const name of ['arm-1', 'arm-2']) programs.robot(socket, name);
  await page.page.goto(`${address}#server`);
  await see(page, 'Hz', 'td');
  await page.page.screenshot({ path: 'picture-server.png' });
}

async function signIn(page, token) {
  await page.page.getByLabel('Token').fill(token);
  await page.page.keyboard.press('Enter');
}

test('data: versions, trials, and their changes', async () => {
  const { address, trainctl } = await begin('data');
  const page = await show(address, '#data');
  await see(page, 'There is no dataset yet');
  await see(page, 'trainctl datasets create arm');
  await page.checkAxe('data-empty');

  await addData(trainctl, `--description=${HOSTILE}`);
  await page.page.reload();
  await see(page, HOSTILE);
  await page.page.getByRole('link', { name: 'arm', exact: true }).click();
  await see(page, '60 trials');
  await see(page, 'Trials of @1');
  assert.equal(await page.page.locator('.bars li').count(), 4);

  // By label, then by text.
  assert.ok(await page.until(() =>
    document.querySelectorAll('tbody [type=checkbox]').length === 50));
  await press(page, 'After →');
  assert.ok(await page.until(() =>
    document.querySelectorAll('tbody [type=checkbox]').length === 10));
  await page.page.getByLabel('Filter by label').selectOption('HU');
  await page.page.getByLabel('Filter by text').fill('glass');
  assert.ok(await page.until(() => {
    const rows = [...document.querySelectorAll('tr:has([type=checkbox])')];
    return rows.length > 0 && rows.length < 25 && rows.every((row) =>
      row.cells[2].innerText === 'HU' && row.innerText.includes('glass'));
  }));

  // A label of a stranger, by keyboard alone.
  await page.page.locator('tbody [type=checkbox]').first().focus();
  await page.page.keyboard.press('Space');
  await press(page, 'Relabel 1 ...');
  await page.page.getByLabel('New label').fill(HOSTILE);
  await page.page.getByLabel('Reason').fill(`a typo ${HOSTILE}`);
  await page.checkAxe('data-relabel');
  await page.page.keyboard.press('Enter');
  await see(page, 'Relabelled 1 trial: this is arm@2 now.', '#told');
  await see(page, `1 relabelled: a typo ${HOSTILE}`);
  await see(page, HOSTILE, '.bars');
  await see(page, 'From version');
  await examine(page, 'data');
  await page.page.goto(`${address}#data/arm/1`);
  await see(page, 'Versions never change');
  assert.ok(await page.page.locator('tbody input').first().isDisabled());

  // What the server refuses, it refuses in its own words.
  await page.page.goto(`${address}#data/arm/2`);
  await see(page, 'Trials of @2');
  await page.page.locator('tbody [type=checkbox]').first().check();
  await press(page, 'Remove 1 ...');
  await page.page.getByLabel('Reason').fill('x'.repeat(2000));
  await page.page.getByRole('button', { name: 'Remove', exact: true }).click();
  await see(page, '[INVALID_CONFIG]', 'dialog .error');
  await page.page.getByLabel('Reason').fill('upside down');
  await page.page.getByRole('button', { name: 'Remove', exact: true }).click();
  await see(page, 'this is arm@3 now', '#told');
  await page.page.goto(`${address}#data/nothing`);
  await see(page, '[DATASET_NOT_FOUND]', '[role=alert]');
  await page.close('data');
});

test('training: a job, a model, and its aliases', async () => {
  const { socket, address, trainctl } = await begin('train');
  await addData(trainctl);
  const page = await show(address, '#train');
  await see(page, 'No job yet');
  await press(page, 'Train a model ...');
  await page.page.getByLabel('Preset').selectOption('paper');
  await page.page.getByLabel('LSTM networks').fill('1');
  await page.page.getByLabel('Note').fill(HOSTILE);
  await press(page, 'Train');
  await see(page, 'Job 1 is requested.', '#told');
  await page.page.locator('.learning canvas').waitFor({ timeout: 30_000 });
  await press(page, 'Cancel the job ...');
  await press(page, 'Cancel the job');
  await see(page, 'cancelled', '.state');
  await see(page, HOSTILE);

  await trainctl('train', '--dataset=arm', '--model=arm', '--preset=paper',
    '--networks=0');
  await page.page.goto(`${address}#train/job/2`);
  await see(page, 'succeeded', '.state');
  await page.page.locator('.learning canvas').waitFor();
  await examine(page, 'train-job');
  await page.page.getByRole('link', { name: 'arm@1' }).first().click();
  await see(page, 'It was not evaluated yet.');
  await press(page, 'Evaluate ...');
  await press(page, 'Evaluate');
  await see(page, 'No test: the model was trained on 60');
  assert.equal(await page.page.locator('.confusion tbody td.right').count(), 4);
  await see(page, 'Accuracy of hardness', '.pairs');
  await see(page, 'Accuracy of mobility', '.pairs');
  assert.equal(await page.page.locator('.drawing').count(), 3);
  const counts = await page.page.locator('.drawing .small').allTextContents();
  assert.equal(counts.reduce((sum, count) => sum + Number(count), 0), 60);
  await page.page.goto(`${address}#train/model/arm/1`);
  await see(page, '95 % interval');
  await examine(page, 'train-model', true);

  await press(page, 'Promote ...');
  await press(page, 'Promote');
  await see(page, 'default names arm@1 now.', '#told');
  await page.page.goto(`${address}#train`);
  await press(page, 'Promote ... default@1');
  await press(page, 'Promote');
  await see(page, 'default names default@1 now.', '#told');
  await press(page, 'Canary ... default');
  await page.page.getByLabel('Version', { exact: true }).fill('arm@1');
  await press(page, 'Set');
  await see(page, '5 % get arm@1');
  await press(page, 'Gate ... default');
  await page.page.getByLabel('Dataset version').fill('arm@1');
  await press(page, 'Set');
  await see(page, 'on arm@1: accuracy');
  await see(page, '5 % get arm@1');
  await examine(page, 'train');
  await press(page, 'Roll back ... default');
  await press(page, 'Roll back to arm@1');
  await see(page, 'default names arm@1 again.', '#told');
  await page.page.getByRole('link', { name: 'default', exact: true }).click();
  await see(page, 'rolled back');
  await drawPictures(page, socket, address, trainctl);
  await page.close('train');
});

test('the server: streams, changes, and its end', async () => {
  const { socket, address, trainctl } = await begin('server');
  await addData(trainctl);
  programs.robot(socket, HOSTILE, '--seed=3');
  const page = await show(address, '#server');
  await see(page, HOSTILE, 'td');
  await see(page, 'datasets/arm/versions/1');
  await see(page, 'of at most');
  await see(page, 'Serving', '.health');
  await see(page, 'Models in memory');
  await examine(page, 'server');
  await page.page.getByLabel('Only what begins with').fill('uploads/');
  assert.ok(await page.until(() =>
    !document.body.innerText.includes('datasets/arm')));

  await press(page, 'Drain ...');
  const drain = page.page.getByRole('button', { name: 'Drain', exact: true });
  assert.ok(await drain.isDisabled());
  await page.page.getByLabel(/^Type unix:/).fill(`unix:${socket}`);
  await drain.click();
  await see(page, 'The server ends: 1 stream', '#told');
  assert.ok(await page.until(() =>
    document.querySelector('[role=alert]') !== null));
  await page.checkAxe('server-gone');
  await page.close('server');
});

// The server decides; the page shows what it may do.
test('roles: what a token may not do is read-only', async () => {
  const tokens = join(programs.folder, 'tokens');
  const tokenOf = async (role) => {
    const maker = programs.start('trainctl', 'tokens', 'create',
      `--name=${role}`, `--role=${role}`, `--file=${tokens}`);
    return (await programs.line(maker, /^\S+$/))[0];
  };
  const viewer = await tokenOf('viewer');
  const trainer = await tokenOf('trainer');
  const { address } = await begin('roles', `--tokens=${tokens}`);
  const page = await show(address, '#data');
  await signIn(page, viewer);
  await see(page, 'Read-only:', '.denied');
  await see(page, 'needs the role trainer');
  await see(page, 'Read-only: your role may not change datasets.', '.drop');
  for (const name of ['Choose files ...', 'Choose a folder ...']) {
    assert.ok(await page.page.getByRole('button', { name }).isDisabled());
  }
  await page.page.goto(`${address}#train`);
  await see(page, 'default@1');
  for (const name of ['Train a model ...', 'Promote ... default@1']) {
    assert.ok(await page.page.getByRole('button', { name }).isDisabled());
  }
  await page.checkAxe('train-read-only');
  await page.page.goto(`${address}#server`);
  await see(page, 'No stream is open');
  await see(page, 'needs the role admin', '.denied');
  await see(page, 'Serving', '.health');
  assert.ok(await page.page.getByRole('button', { name: 'Drain ...' })
    .isDisabled());

  await press(page, 'Sign out');
  await signIn(page, trainer);
  await page.page.goto(`${address}#train`);
  await see(page, 'No job yet');
  assert.ok(await page.until(() => {
    const named = (name) => [...document.querySelectorAll('button')]
      .find((button) => button.ariaLabel === name ||
        button.innerText === name);
    return !named('Train a model ...').disabled &&
      named('Promote ... default@1')?.disabled;
  }));

  // A sign-in that ends elsewhere.
  const cookies = await page.context.cookies();
  await page.context.clearCookies();
  await page.page.goto(`${address}#data`);
  await page.page.getByLabel('Token').waitFor();
  await page.context.addCookies(cookies);
  await page.close('roles');
});

// Every text of every message, whatever servers check today.
test('no text of a server is markup', async () => {
  const { socket, address, trainctl } = await begin('hostile');
  await addData(trainctl);
  await trainctl('train', '--dataset=arm', '--model=arm', '--preset=paper',
    '--networks=0');
  await trainctl('evaluate', '--dataset=arm@1', '--model=arm@1');
  await trainctl('models', 'promote', 'arm@1');
  programs.robot(socket, 'arm');
  const page = await show(address, '#data');
  const KEPT = ['next_page_token', 'state', 'kind', 'data', 'name'];
  const spoil = (value, key) => {
    if (Array.isArray(value)) return value.map((item) => spoil(item, key));
    if (value && typeof value === 'object') {
      return Object.fromEntries(Object.entries(value).map(([name, item]) =>
        [key === 'labels' ? name + HOSTILE : name, spoil(item, name)]));
    }
    const isText = typeof value === 'string' && !/^-?\d+$/.test(value);
    return isText && !KEPT.includes(key) ? value + HOSTILE : value;
  };
  await page.page.route('**/api/servers/**', async (route) => {
    const response = await route.fetch();
    const json = spoil(await response.json(), '');
    await route.fulfill({ response, json });
  });
  await page.page.reload();
  for (const [where, text] of [['data', 'unix'], ['data/arm/1', '60 trials'],
    ['train', 'arm@1'], ['train/job/1', 'succeeded'],
    ['train/job/2', 'Accuracy'], ['train/model/arm/1', 'paper'],
    ['train/alias/default', 'promoted'], ['server', 'create'],
    ['data/none', 'NOT_FOUND']]) {
    await page.page.goto(`${address}#${where}`);
    await see(page, HOSTILE);
    await see(page, text);
    assert.equal(await page.page.locator('main img, main script').count(), 0);
  }
  await page.close('hostile');
});

test('several servers: one is chosen', async () => {
  const first = await begin('first');
  const second = await begin('second');
  await addData(second.trainctl);
  const address = await programs.console(first.socket,
    `--server=unix:${second.socket}`);
  const page = await show(address, '#data');
  await see(page, 'There is no dataset yet');
  await examine(page, 'servers');
  await page.page.getByLabel('Server', { exact: true }).selectOption('1');
  await see(page, 'unix');
  assert.ok(page.page.url().endsWith('#data@1'), page.page.url());
  await page.page.getByRole('link', { name: 'arm', exact: true }).click();
  await see(page, 'Trials of @1');
  await page.page.getByRole('link', { name: 'Train' }).click();
  assert.ok(page.page.url().endsWith('#train@1'), page.page.url());
  await page.page.getByRole('link', { name: 'Live' }).click();
  await see(page, 'No robot is streaming');
  assert.ok(await page.page.locator('#server').isHidden());
  await page.close('servers');
});

test('a console that is started again knows its page again', async () => {
  const { socket, address } = await begin('again');
  const flags = [`--server=unix:${socket}`, `--listen=${new URL(address).host}`];
  const page = await show(address, '#server');
  await see(page, 'Runs for');
  await programs.stop(programs.consoles.pop());
  await page.page.getByRole('link', { name: 'Data' }).click();
  await see(page, 'The console does not answer.', '[role=alert]');
  await page.checkAxe('no console');
  const second = programs.start('tactus-console', ...flags);
  await programs.line(second, /^console: /);
  await press(page, 'Try again');
  await see(page, 'There is no dataset yet');
  await page.close('again');
});
