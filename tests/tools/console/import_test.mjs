// Files that people import on the console's data page become what trainctl
// makes of them, in its words.

import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { promisify } from 'node:util';

import { browserOf } from './browser.mjs';
import { BrowserPage } from './browser_page.mjs';
import { Programs } from './programs.mjs';

const HOSTILE = '"><img src=x onerror=window.hacked=1>';
const FILES = 'input[type=file]:not([webkitdirectory])';
const FOLDER = 'input[webkitdirectory]';
const tally = { check: (condition, text) => assert.ok(condition, text) };
const programs = new Programs();
const run = promisify(execFile);
const at = (...parts) => join(programs.folder, ...parts);
const browser = await browserOf(programs);
// A server with a data directory, and its console.
let server;
let address;

before(async () => {
  const socket = at('server.sock');
  await programs.server(socket, `--data-dir=${at('data')}`);
  server = `--server=unix:${socket}`;
  mkdirSync(at('imports'));
  address = await programs.console(socket, `--import-folder=${at('imports')}`);
});

const trainctl = (...words) =>
  run(join(process.env.TACTUS_BIN, 'trainctl'), words);

// Folders of imports that have not gone.
const leftBehind = () => readdirSync(at('imports')).flatMap((folder) =>
  readdirSync(at('imports', folder)));

async function nothingIsLeft(page) {
  for (let tries = 0; leftBehind().length > 0 && tries < 200; ++tries) {
    await page.page.waitForTimeout(50);
  }
  assert.deepEqual(leftBehind(), []);
}

const open = (where = '#data') =>
  BrowserPage.open(browser, address + where, tally, '.');

const see = async (page, text, selector) => assert.ok(
  await page.untilText(text, selector), `"${text}" is not there; but:\n` +
    await page.text());

const press = (page, name) =>
  page.page.getByRole('button', { name, exact: true }).click();

// Makes the dataset in the dialog that the choice of a new one opens.
async function chooseNew(page, name) {
  await page.page.getByLabel('Into the dataset').selectOption('a new one ...');
  await page.page.getByLabel('Name', { exact: true }).fill(name);
  await press(page, 'Make it');
  assert.ok(await page.until((wanted) =>
    document.getElementById('import-dataset').value === wanted, name));
}

// The trials of a dataset's newest version, but for when and by whom.
async function contentOf(dataset) {
  const { stdout } = await trainctl('datasets', 'show', dataset, '--trials',
    '--json', server);
  return JSON.parse(stdout).trials;
}

// What the same files become by hand.
async function contentByHand(dataset, ...words) {
  const out = `--out=${at(`${dataset}.h5`)}`;
  await trainctl('import', ...words, out);
  await trainctl('datasets', 'create', dataset, server);
  await trainctl('datasets', 'upload', dataset,
    `--data=${at(`${dataset}.h5`)}`, server);
  return contentOf(dataset);
}

// A folder of two recordings of a skin of 2 x 2 taxels.
function writeFolder(name) {
  mkdirSync(at(name, 'frames'), { recursive: true });
  writeFileSync(at(name, 'skin.json'), JSON.stringify({ name: 'mine', rows: 2,
    columns: 2, row_pitch_m: 0.01, column_pitch_m: 0.01, unit: 'counts',
    contact_threshold: 2, onset_threshold: 3, sample_rate_hz: 50 }));
  writeFileSync(at(name, 'trials.csv'), 'frames,label,condition\n' +
    'frames/a.csv,cork,monday\nframes/b.csv,felt,tuesday\n');
  const frames = (value) => Array.from({ length: 30 }, (_, i) =>
    `0.5,${value},${i * 7 % 5},1\n`).join('');
  writeFileSync(at(name, 'frames', 'a.csv'), frames(7));
  writeFileSync(at(name, 'frames', 'b.csv'), frames(9));
  writeFileSync(at(name, '.DS_Store'), 'of a desktop');
}

test('a trial file becomes a version, and the same one twice none', async () => {
  await programs.run('trainctl', 'simulate', '--protocol=grid', '--sample=12',
    '--seed=1', `--out=${at('trials.h5')}`);
  const page = await open();
  await see(page, 'There is no dataset yet');
  await see(page, 'Drop files or a folder here');
  await page.page.setInputFiles(FILES, at('trials.h5'));
  await see(page, '1 file to import.');
  // By keyboard alone: the focus is where one goes on.
  await page.page.keyboard.press('Enter');
  await see(page, 'What the import would make');
  await see(page, 'Nothing is on the server yet.');
  await see(page, 'HU', '.import-result .bars');
  assert.ok(await page.page.getByRole('button', { name: 'Import', exact: true })
    .isDisabled());
  assert.equal(await page.page.evaluate(() => document.activeElement.id),
    'import-dataset');
  await page.checkAxe('import');
  await chooseNew(page, 'arm');
  await press(page, 'Import');
  await see(page, 'Imported 12 new trials: this is arm@1 now, with 12 trials.');
  await see(page, 'arm@1', 'table');
  assert.equal(await page.page.evaluate(() =>
    document.activeElement.innerText), 'arm@1');
  await nothingIsLeft(page);
  assert.deepEqual(await contentOf('arm'),
    await contentByHand('arm-by-hand', at('trials.h5')));

  // On the page of the dataset.
  await page.page.keyboard.press('Enter');
  await see(page, 'Trials of @1');
  await page.page.setInputFiles(FILES, at('trials.h5'));
  await press(page, 'Check');
  await see(page, 'Nothing is on the server yet.');
  await press(page, 'Import');
  await see(page, '12 of the trials were there already and were left out');
  await see(page, 'this is arm@2 now, with 12 trials');
  await see(page, '12 known already', 'table');
  await page.close('import');
});

test('a folder is refused in trainctl\'s words, and put right', async () => {
  writeFolder('recordings');
  const table = at('recordings', 'trials.csv');
  writeFileSync(at('recordings', 'frames', 'b.csv'), '1,2,3,4\n1,2,x,4\n');
  const failed = await trainctl('import', at('recordings'),
    `--out=${at('no.h5')}`).catch((error) => error);
  assert.equal(failed.code, 1);
  const words = failed.stderr.trim().split('trainctl: ').pop()
    .replaceAll(at('recordings'), '.');
  assert.match(words, /trials.csv: line 3: frames: .*b.csv/);

  const page = await open();
  await page.page.setInputFiles(FOLDER, at('recordings'));
  await see(page, '4 files to import. 1 hidden file left out.');
  await press(page, 'Check');
  await see(page, words.replace(/\s+/g, ' '), '.import-answer [role=alert]');
  await page.checkAxe('import-refused');
  await press(page, 'Remove frames/b.csv');
  await press(page, 'Check');
  await see(page, 'trials.csv: line 3', '.import-answer [role=alert]');
  writeFolder('recordings');
  await page.page.setInputFiles(FOLDER, at('recordings'));
  await press(page, 'Check');
  await see(page, 'mine, 2 × 2 taxels', '.import-result');
  await chooseNew(page, 'mine');
  await press(page, 'Import');
  await see(page, 'this is mine@1 now, with 2 trials');
  const trials = await contentOf('mine');
  assert.deepEqual(trials.map(({ source, label }) => [source, label]),
    [['frames/a.csv', 'cork'], ['frames/b.csv', 'felt']]);
  assert.deepEqual(trials,
    await contentByHand('mine-by-hand', at('recordings')));

  // Other labels for the same frames: the person decides.
  writeFileSync(table, 'frames,label,condition\nframes/a.csv,wool,monday\n');
  await page.page.setInputFiles(FOLDER, at('recordings'));
  await press(page, 'Check');
  await see(page, 'Nothing is on the server yet.');
  await page.page.getByLabel('Into the dataset').selectOption('mine');
  await press(page, 'Import');
  await see(page, 'wool', '.import-answer [role=alert]');
  await page.page.getByLabel('Replace labels of recordings that are there').check();
  await press(page, 'Import');
  await see(page, '1 of the trials took the place of trials with the same ' +
    'frames: frames/a.csv (wool, was cork)');
  await page.close('folder');
});

test('dropped files, with names and labels of a stranger', async () => {
  const page = await open();
  const signals = 'time,force,area,motion\n0,1,2,3\n0.01,1,2,3\n';
  const drop = async (selector, files) => {
    const data = await page.page.evaluateHandle((all) => {
      const transfer = new DataTransfer();
      for (const [name, text] of all) transfer.items.add(new File([text], name));
      return transfer;
    }, files);
    await page.page.dispatchEvent(selector, 'drop', { dataTransfer: data });
  };
  // What is dropped beside the place is not opened instead of the page.
  await drop('h1', [['a.csv', signals]]);
  await see(page, 'Drop files or a folder here');
  await drop('.drop', [[`${HOSTILE}.csv`, signals]]);
  await see(page, HOSTILE, '.picked');
  await page.page.getByLabel('Label', { exact: true }).fill(HOSTILE);
  await press(page, 'Check');
  await see(page, HOSTILE, '.import-result .bars');
  await chooseNew(page, 'strange');
  await press(page, 'Import');
  await see(page, 'this is strange@1 now, with 1 trial.');
  const [trial] = await contentOf('strange');
  assert.equal(trial.label, HOSTILE);
  assert.equal(trial.source, `${HOSTILE}.csv`);

  // A recording with a table of its contacts.
  await programs.run('tactus-stream', server, '--driver=sim', '--rate=max',
    '--trials=2', '--seed=5', `--record=${at('run.mcap')}`);
  writeFileSync(at('contacts.csv'), 'contact,label\n1,left\n2,right\n');
  await page.page.setInputFiles(FILES, [at('run.mcap'), at('contacts.csv')]);
  await see(page, '2 files to import.');
  await press(page, 'Check');
  await see(page, 'left', '.import-result .bars');
  await page.page.getByLabel('Into the dataset').selectOption('strange');
  await press(page, 'Import');
  await see(page, 'Imported 2 new trials');
  const byHand = await contentByHand('run-by-hand', at('run.mcap'),
    `--table=${at('contacts.csv')}`);
  const bySha = (trials) => trials.map(({ sha256 }) => sha256).sort();
  const own = bySha(await contentOf('strange'));
  assert.ok(bySha(byHand).every((sha256) => own.includes(sha256)));
  await page.close('drop');
});

test('two windows of one person, and one that goes', async () => {
  writeFolder('other');
  const first = await open();
  const second = await open();
  for (const page of [first, second]) {
    await page.page.setInputFiles(FOLDER, at('other'));
    await see(page, '4 files to import.');
  }
  await press(first, 'Check');
  await see(first, 'Nothing is on the server yet.');
  await press(second, 'Check');
  await see(second, 'another import of yours is under way', '[role=alert]');
  await press(second, 'End it and go on');
  await see(second, 'Nothing is on the server yet.');
  await chooseNew(first, 'other');
  await press(first, 'Import');
  await see(first, 'the import has ended', '[role=alert]');
  // Leaving the page ends it, too.
  assert.equal(leftBehind().length, 1);
  await second.page.getByRole('link', { name: 'Train' }).click();
  await see(second, 'No job yet');
  await nothingIsLeft(second);
  await first.close('first window');
  await second.close('second window');
});
