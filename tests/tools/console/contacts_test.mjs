// What people see and do on the console's page of contacts, with a real server
// that keeps them, and robots that touch.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';

import { browserOf } from './browser.mjs';
import { ContactsPage } from './contacts_page.mjs';
import { Programs } from './programs.mjs';

const HOSTILE = '"><img src=x onerror=window.hacked=1>';
const programs = new Programs();
const browser = await browserOf(programs);
let log;

before(async () => {
  log = await begin('log', '--keep-contacts=64M');
});

async function begin(name, ...flags) {
  const socket = join(programs.folder, `${name}.sock`);
  await programs.server(socket, `--data-dir=${join(programs.folder, name)}`,
    ...flags);
  const address = await programs.console(socket);
  const trainctl = (...words) =>
    programs.run('trainctl', ...words, `--server=unix:${socket}`);
  return { socket, address, trainctl };
}

const touch = (socket, robot, trials, seed, ...flags) =>
  programs.run('tactus-stream', `--server=unix:${socket}`, '--driver=sim',
    '--rate=max', `--trials=${trials}`, `--seed=${seed}`,
    `--client-id=${robot}`, ...flags);

test('a server that keeps none says which flag keeps them', async () => {
  const { address } = await begin('none');
  const page = await ContactsPage.open(browser, `${address}#contacts`);
  await page.see('This server keeps no contacts');
  await page.see('--keep-contacts=1G', 'pre');
  await page.checkAxe('no contact log');
  await page.close();
});

test('contacts come, are filtered, and are played', async () => {
  const { socket, address } = log;
  const page = await ContactsPage.open(browser, `${address}#contacts`);
  await page.see('No contact yet');
  await page.see('tactus-stream --server=', 'pre');
  await page.checkAxe('no contact yet');

  // The first ones come by themselves, later ones when somebody wants them.
  await touch(socket, 'arm-1', 6, 1);
  await page.see('arm-1', 'td');
  await touch(socket, HOSTILE, 3, 3);
  await page.see('There are newer ones: show');
  await page.press('There are newer ones: show');
  await page.see(HOSTILE, 'td');
  await page.see('The replay has the same answers, bit for bit.');
  await page.reloadUntil(9);
  const all = (await page.rows()).length;

  // Filters are in the address.
  await page.page.getByLabel('Robot', { exact: true }).fill('arm-1');
  await page.page.keyboard.press('Enter');
  assert.ok(await page.untilRows((rows) => rows.length > 4 &&
    rows.every(({ robot }) => robot === 'arm-1')));
  await page.page.getByLabel('Order').selectOption('uncertain');
  assert.ok(await page.until(() => location.hash.includes('order=uncertain')));
  await page.page.reload();
  assert.ok(await page.untilRows((rows) => rows.length > 4 &&
    rows.every(({ robot }) => robot === 'arm-1')));
  const sure = (await page.rows()).map(({ percent }) => percent);
  assert.deepEqual(sure, [...sure].sort((a, b) => a - b));
  const { answered } = (await page.rows())[0];
  await page.page.getByLabel('Answer', { exact: true }).fill(answered);
  await page.page.keyboard.press('Enter');
  assert.ok(await page.untilRows((rows) => rows.length > 0 &&
    rows.every((row) => row.answered === answered)));
  for (const flag of ['Unknown', 'Undecided', 'Revised', 'Shadow disagrees']) {
    await page.press(flag);
  }
  await page.see('No contact is like that');
  assert.match(page.page.url(), /\/unknown\/undecided\/revised\/disagreeing$/);
  await page.checkAxe('no contact fits');
  await page.press('Show all');
  assert.ok(await page.untilRows((rows, n) => rows.length === n, all));

  // The address names the open contact, and a way back through history.
  await page.page.goBack();
  await page.see('No contact is like that');
  await page.page.goto(`${address}#contacts/2`);
  await page.see('Contact 2', '.contact-view h2');
  await page.untilPlayable();

  // Play, pause, and frame by frame.
  await page.page.locator('[aria-current=true]').last().focus();
  const slider = page.page.getByRole('slider');
  await page.page.keyboard.press('Space');
  await page.see('Pause', '.pause');
  await page.page.keyboard.press('Space');
  await page.see('Play', '.pause');
  const at = Number(await slider.inputValue());
  await page.page.keyboard.press('ArrowLeft');
  assert.equal(Number(await slider.inputValue()), at - 1);
  await page.page.locator('.events button').first().click();
  assert.notEqual(Number(await slider.inputValue()), at - 1);

  // A second opinion.
  await page.page.getByLabel('Ask another model').selectOption('no-poses@1');
  await page.see('Answers of no-poses@1');
  await page.examine('contacts');
  await page.close();
});

test('labels are given by keys and clicks, and saved', async () => {
  const { address, trainctl } = log;
  const page = await ContactsPage.open(browser, `${address}#contacts`);
  const { keyboard } = page.page;
  assert.ok(await page.untilRows((rows) => rows.length > 7));
  const rows = await page.rows();
  await page.see('4', '.classes kbd');
  await page.see('No new label', '.count');

  await keyboard.press('3');
  await page.see('1 label', '.count');
  assert.equal((await page.rows())[0].draft, 'SU');
  assert.equal(await page.current(), rows[1].number);
  await keyboard.press('Enter');
  await page.see('confirmed, not saved', 'td');
  assert.equal((await page.rows())[1].draft, rows[1].answered);
  await keyboard.press('u');
  await page.see('1 label', '.count');
  assert.equal(await page.current(), rows[1].number);
  for (const [key, place] of [['j', 2], ['ArrowDown', 3], ['k', 2],
    ['ArrowUp', 1], ['ArrowUp', 0]]) {
    await keyboard.press(key);
    assert.equal(await page.current(), rows[place].number, key);
  }
  await keyboard.press('x');
  await page.see('No new label', '.count');
  await keyboard.press('u');
  await page.see('1 label', '.count');

  // Several at once, by keys and by mouse; a label that no model has.
  await keyboard.press('ArrowDown');
  await keyboard.press('Shift+ArrowDown');
  await page.see('Label 2 contacts', 'h3');
  await keyboard.press('1');
  await page.see('3 labels', '.count');
  for (const place of [4, 5]) {
    await page.page.getByLabel(`Pick contact ${rows[place].number}`,
      { exact: true }).check();
  }
  await page.page.locator('.classes').getByRole('button', { name: 'HM' })
    .first().click();
  await page.see('5 labels', '.count');
  assert.equal(await page.current(), rows[3].number);
  await page.press('Other ...');
  await page.page.getByLabel('Label', { exact: true }).fill(HOSTILE);
  await page.checkAxe('another label');
  await keyboard.press('Enter');
  await page.see('6 labels', '.count');
  await page.see(HOSTILE, '.draft');

  // Loading the page anew loses none.
  await page.page.reload();
  await page.see('6 labels', '.count');
  // Labels that are not saved are there before the contacts are.
  assert.ok(await page.untilRows((rows) => rows.length > 7));
  assert.deepEqual((await page.rows()).slice(0, 6).map(({ draft }) => draft),
    ['SU', 'HU', 'HU', HOSTILE, 'HM', 'HM']);

  await page.press('Save');
  await page.see('Choose the dataset', '.told');
  await page.page.getByLabel('for', { exact: true })
    .selectOption({ label: 'a new one ...' });
  await page.page.getByLabel('Name').fill('corrected');
  await keyboard.press('Enter');
  assert.ok(await page.until(() => !document.querySelector('dialog')));
  // What the server says is shown, and the labels stay.
  await trainctl('datasets', 'delete', 'corrected');
  await page.page.getByLabel('Reason').fill(`seen ${HOSTILE}`);
  await page.press('Save');
  await page.see('[DATASET_NOT_FOUND]', '.told');
  await page.see('6 labels', '.count');
  await page.examine('contacts-labels');

  // The answer is lost: the same request does its work once.
  await trainctl('datasets', 'create', 'corrected');
  const ids = [];
  await page.page.route('**/LabelContacts', async (route) => {
    ids.push(route.request().postDataJSON().request_id);
    if (ids.length > 1) return route.continue();
    await route.fetch();
    return route.abort();
  });
  await page.press('Save');
  await page.see('The console does not answer.', '.told');
  await page.see('6 labels', '.count');
  await page.press('Save');
  await page.see('Saved 6 labels: this is corrected@1 now.', '.told');
  assert.equal(ids.length, 2);
  assert.equal(ids[0], ids[1]);
  await page.see(HOSTILE, '.given');
  await page.page.getByLabel('Labels', { exact: true })
    .selectOption('yes');
  assert.ok(await page.untilRows((listed) => listed.length === 6));
  await page.page.getByRole('link', { name: 'corrected@1' }).click();
  await page.see('6 trials');
  await page.see(`seen ${HOSTILE}`);
  await page.close();
});

// The picture of docs/console.md.
test('several robots have touched', async () => {
  const { socket, address } = await begin('shown', '--keep-contacts=64M');
  await Promise.all([4, 5, 6].map((seed) =>
    touch(socket, `arm-${seed}`, 4, seed)));
  const page = await ContactsPage.open(browser, `${address}#contacts`);
  await page.reloadUntil(8);
  await page.page.getByLabel('Order').selectOption('uncertain');
  assert.ok(await page.until(() => location.hash.includes('order=uncertain')));
  await page.see('4', '.classes kbd');
  for (const key of ['1', 'Enter', '4']) await page.page.keyboard.press(key);
  await page.see('3 labels', '.count');
  await page.untilPlayable();
  await page.page.waitForTimeout(200);
  await page.page.screenshot({ path: 'picture-contacts.png',
    clip: { x: 0, y: 0, width: 1440, height: 720 } });
  await page.close();
});

test('two people see what the other one has labelled', async () => {
  const { address } = log;
  const [ann, bob] = await Promise.all([1, 2].map(() => ContactsPage.open(
    browser, `${address}#contacts/labelled=no`)));
  for (const page of [ann, bob]) {
    assert.ok(await page.untilRows((rows) => rows.length > 1));
    await page.see('4', '.classes kbd');
  }
  const before = await ann.rows();
  await ann.page.keyboard.press('2');
  await ann.see('1 label', '.count');
  await bob.page.keyboard.press('4');
  await bob.page.getByLabel('for', { exact: true })
    .selectOption('corrected');
  await bob.press('Save');
  await bob.see('Saved 1 label: this is corrected@2 now.', '.told');
  // Rows stay where they are, and so does the label that is not saved.
  await ann.see('before: SM', 'td');
  const now = await ann.rows();
  assert.deepEqual(now.map(({ number }) => number),
    before.map(({ number }) => number));
  assert.equal(now[0].draft, 'HM');
  await ann.close();
  await bob.close();
});

test('who may only look labels nothing', async () => {
  const tokens = join(programs.folder, 'tokens');
  const file = join(programs.folder, 'robot-token');
  const tokenOf = async (role, ...flags) => {
    const maker = programs.start('trainctl', 'tokens', 'create',
      `--name=${role}`, `--role=${role}`, `--file=${tokens}`, ...flags);
    return (await programs.line(maker, /^\S+$/))[0];
  };
  writeFileSync(file, await tokenOf('robot'));
  const viewer = await tokenOf('viewer');
  const { socket, address } = await begin('roles', `--tokens=${tokens}`,
    '--keep-contacts=64M');
  await touch(socket, 'arm-1', 2, 1, `--token-file=${file}`);
  const page = await ContactsPage.open(browser, `${address}#contacts`);
  await page.page.getByLabel('Token').fill(viewer);
  await page.page.keyboard.press('Enter');
  await page.see('arm-1', 'td');
  await page.see('Read-only: your role may not label contacts', '.denied');
  await page.see('bit for bit', '.contact-view');
  for (const key of ['1', 'Enter']) await page.page.keyboard.press(key);
  assert.ok((await page.rows()).every(({ draft }) => draft === ''));
  assert.equal(await page.page.locator('.label-bar').count(), 0);
  await page.checkAxe('contacts read-only');
  await page.page.screenshot({ path: 'contacts-read-only.png' });
  await page.close();
});
