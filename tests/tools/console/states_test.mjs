// Tests the states of the console's page in a browser, against a made-up
// console.
//
//   node states_test.mjs PAGE_DIR PICTURES_DIR [CHROMIUM [TEST ...]]
//
// No check asks how long something takes: the machine may be busy. Rates are
// printed.

import { mkdir } from 'node:fs/promises';

import { launchBrowser } from './browser.mjs';
import { BrowserPage } from './browser_page.mjs';
import { DEGRADED, jobsOf, serverAnswers, trainAnswers } from
  './fake_answers.mjs';
import { FakeConsole } from './fake_console.mjs';
import { FakeRobot, makeRobots } from './fake_robot.mjs';

const [pageDir, pictures, executablePath, ...chosen] = process.argv.slice(2);
const IMAGE = '<img src=x onerror="window.hacked=1">';
const SCRIPT = '"><script>window.hacked=1</script>';

const tally = {
  passed: 0,
  failed: 0,
  check(condition, text) {
    if (condition) ++this.passed;
    else ++this.failed;
    if (!condition) console.log(`    FAILED ${text}`);
  },
};

const tests = {
  async 'no robot'({ page }) {
    tally.check(await page.untilText('No robot is streaming'), 'empty state');
    tally.check((await page.text()).includes('tactus-stream --server='),
      'the empty state says what to do');
    await page.examine('empty');
  },

  async 'one robot'({ page }) {
    await page.page.waitForSelector('[data-robot="arm-1"]');
    await page.untilText('✓ hard');
    await page.examine('one');
  },

  async 'four robots'({ page }) {
    await page.page.waitForSelector('[data-robot="arm-4"]');
    tally.check((await page.names()).join() === 'arm-1,arm-2,arm-3,arm-4',
      'tiles in the order of their names');
    tally.check(await page.untilText('✓ hard'), 'a decision is marked');
    tally.check(await page.untilText('? unknown'), 'an unknown is marked');
    tally.check(await page.untilText('12 frames lost'), 'losses are shown');
    const label = '[data-robot="arm-2"] canvas[role="img"]';
    tally.check(await page.until((selector) => /2 contacts, largest .* N/.test(
      document.querySelector(selector).ariaLabel), label), 'the skin in words');
    await page.examine('four');
  },

  async 'twenty robots'({ page }) {
    await page.page.waitForSelector('[data-robot="arm-20"]');
    await page.examine('twenty');
    // So high that all tiles are in sight.
    await page.page.setViewportSize({ width: 1440, height: 3200 });
    await page.page.waitForTimeout(500);
    const { counts, seconds, messages } = await page.page.evaluate(async () => {
      const before = new Map(window.tactus.drawn);
      const begun = performance.now();
      const heard = window.tactus.messages;
      await new Promise((resolve) => setTimeout(resolve, 6000));
      const spent = (performance.now() - begun) / 1000;
      const drawn = [...window.tactus.drawn].map(([key, count]) =>
        count - (before.get(key) ?? 0));
      return { counts: drawn, seconds: spent,
        messages: window.tactus.messages - heard };
    });
    tally.check(counts.length === 20 && Math.min(...counts) > 0,
      `all 20 robots are drawn (${counts})`);
    const rates = counts.map((count) => count / seconds);
    console.log('    frames drawn per second and robot: ' +
      `${Math.min(...rates).toFixed(1)} to ` +
      `${Math.max(...rates).toFixed(1)}; ` +
      `messages ${(messages / seconds).toFixed(1)}`);
    const delays = await page.page.evaluate(() => [...window.tactus.delays]
      .sort((a, b) => a - b));
    const at = (part) => delays[Math.floor(part * (delays.length - 1))];
    console.log(`    delay in ms: half ${at(0.5).toFixed(1)}, ` +
      `99 % ${at(0.99).toFixed(1)}`);
  },

  async 'only tiles in sight are drawn'({ page, fake }) {
    fake.robots.push(...makeRobots(20).slice(1));
    await page.page.waitForSelector('[data-robot="arm-20"]');
    await page.page.setViewportSize({ width: 768, height: 500 });
    await page.page.waitForTimeout(500);
    const grown = await page.page.evaluate(async () => {
      const before = new Map(window.tactus.drawn);
      await new Promise((resolve) => setTimeout(resolve, 1500));
      return [...window.tactus.drawn].filter(([key, count]) =>
        count > (before.get(key) ?? 0)).length;
    });
    tally.check(grown > 0 && grown < 20, `${grown} of 20 tiles are drawn`);
  },

  async 'full view'({ page, fake }) {
    fake.robots.push(...makeRobots(4).slice(1));
    await page.page.waitForSelector('[data-robot="arm-2"]');
    await page.page.focus('[data-robot="arm-2"] a');
    await page.page.keyboard.press('Enter');
    await page.page.waitForSelector('.full[data-robot="arm-2"]');
    tally.check(page.page.url().includes('#robot=0%2F2'), 'its address');
    tally.check(await page.untilText('touched', '.events li'), 'an event');
    await page.untilText('now mobility moved', '.events li');
    await page.untilText('✓ moved');
    await page.examine('full');
    tally.check(await page.page.$$eval('.chart canvas', (all) =>
      all.length === 5 && all.every((c) => c.width > 0)), 'five charts');
    await pauseAndScrub(page);
    await pickTaxels(page);
    await chooseContact(page);
    await page.examine('paused');
    await page.page.keyboard.press('Escape');
    await page.page.waitForSelector('.grid [data-robot="arm-1"]');
    tally.check(await page.page.evaluate(() => document.activeElement
      .closest('[data-robot]')?.dataset.robot) === 'arm-2',
    'Escape goes back to the tile');
  },

  async 'an address of a robot'({ page, fake }) {
    await page.page.goto(`${fake.url}#robot=0%2F1`);
    await page.page.reload();
    await page.page.waitForSelector('.full[data-robot="arm-1"]');
    tally.check(true, 'opens it');
    await page.page.goto(`${fake.url}#robot=%E0%A4%A`);
    tally.check(await page.page.waitForSelector('.grid [data-robot]')
      .then(() => true, () => false), 'a broken address shows all robots');
  },

  async 'silent, lost, and again'({ page, fake }) {
    fake.robots.push(...makeRobots(4).slice(1));
    await page.page.waitForSelector('[data-robot="arm-4"]');
    fake.robots[0].silent = true;
    fake.end(fake.robots[1]);
    tally.check(await page.untilText('silent for', '[data-robot="arm-1"]'),
      'a silent robot');
    tally.check(await page.untilText('ended', '[data-robot="arm-2"]'),
      'a robot that has ended');
    await page.examine('stale');
    const again = new FakeRobot(21, 'arm-2');
    fake.robots.push(again);
    await page.until(() => document.querySelector(
      '[data-robot="arm-2"] .stale').hidden);
    tally.check((await page.names()).join() === 'arm-1,arm-2,arm-3,arm-4',
      'a robot that comes again takes its place');
    fake.setServer('connecting', `no route ${IMAGE}`);
    tally.check(await page.untilText('offline', '[data-robot="arm-3"]'),
      'a server that goes');
    tally.check(await page.untilText(`no route ${IMAGE}`, '#notice'),
      'its error is text');
    await page.examine('offline');
    fake.robots.splice(2, 1);
    fake.setServer('connected');
    tally.check(await page.until(() => !document.querySelector(
      '[data-robot="arm-3"]')), 'a robot that does not return goes');
    tally.check(await page.until(() => document.querySelector(
      '[data-robot="arm-4"] .stale').hidden), 'a server that returns');
    tally.check((await page.names()).join() === 'arm-1,arm-2,arm-4',
      'no robot is there twice');
  },

  async 'the console goes and returns'({ page, fake }) {
    await page.page.waitForSelector('[data-robot="arm-1"]');
    const { port } = fake;
    await fake.close();
    tally.check(await page.untilText('Reconnecting', '#notice'), 'it says so');
    tally.check(await page.untilText('offline', '[data-robot="arm-1"]'),
      'robots are offline');
    await page.examine('reconnecting');
    const other = new FakeConsole(pageDir, fake.robots);
    await other.listen(port);
    tally.check(await page.until(() =>
      document.querySelector('#notice').hidden &&
      document.querySelector('[data-robot="arm-1"] .stale').hidden),
    'it goes on');
    tally.check((await page.names()).length === 1, 'no robot is there twice');
    await other.close();
  },

  async 'a full view outlives its stream'({ page, fake }) {
    await page.page.click('[data-robot="arm-1"] a');
    await page.page.waitForSelector('.full');
    fake.end(fake.robots[0]);
    tally.check(await page.untilText('ended', '.full .stale'), 'it has ended');
    fake.robots.push(new FakeRobot(9, 'arm-1'));
    tally.check(await page.until(() => location.hash === '#robot=0%2F9'),
      'the next stream takes its place');
  },

  async 'an address for Foxglove'({ page, fake }) {
    await page.context.grantPermissions(['clipboard-read', 'clipboard-write']);
    const copy = page.page.getByRole('button',
      { name: 'Copy address for Foxglove' });
    await copy.focus();
    await page.page.keyboard.press('Enter');
    tally.check(await page.untilText('The address is copied', '#told'),
      'it says so');
    const address = `ws://127.0.0.1:${fake.port}/foxglove?key=watch-1`;
    tally.check(await page.page.evaluate(() =>
      navigator.clipboard.readText()) === address, 'the address');
    await page.examine('foxglove');
    await page.page.evaluate(() => {
      navigator.clipboard.writeText = () => Promise.reject(new Error('no'));
    });
    await copy.click();
    tally.check(await page.untilText(`The address is ${address}`, '#told'),
      'a browser that does not copy');
    fake.signedIn = false;
    await copy.click();
    tally.check(await page.untilText('Nobody is signed in', '#told'),
      'without a sign-in there is none');
  },

  async 'a refused server'({ page, fake }) {
    fake.setServer('refused', 'the token has no role');
    tally.check(await page.untilText('refused (the token has no role)',
      '#notice'), 'its text');
    await page.examine('refused');
  },

  async 'sign-in'({ page, fake }) {
    await page.page.waitForSelector('#token');
    tally.check((await page.text()).includes('trainctl tokens create'),
      'it says where tokens come from');
    await page.examine('sign-in');
    await page.page.fill('#token', 'wrong');
    await page.page.keyboard.press('Enter');
    tally.check(await page.untilText(
      'the token is unknown <img src=x', '.error'), 'a wrong token');
    await page.examine('wrong-token');
    await page.page.fill('#token', 'right');
    await page.page.keyboard.press('Enter');
    await page.page.waitForSelector('[data-robot="arm-1"]');
    tally.check((await page.text('#person')).includes('lab'), 'who it is');
    fake.signOut();
    tally.check(await page.untilText('no longer valid', '.error'),
      'a sign-in that ends');
    await page.page.fill('#token', 'right');
    await page.page.keyboard.press('Enter');
    await page.page.waitForSelector('[data-robot="arm-1"]');
    await page.page.click('#sign-out');
    await page.page.waitForSelector('#token');
    tally.check(!fake.signedIn, 'sign-out');
  },

  async 'files to import'({ page, fake }) {
    const state = importAnswers(fake);
    await page.page.goto(`${fake.url}#data`);
    tally.check(await page.untilText('Drop files or a folder here'),
      'where files go');
    await page.checkAxe('nothing to import');
    const pick = (...sizes) => page.page.setInputFiles(
      'input[type=file]:not([webkitdirectory])', sizes.map((size, i) =>
        ({ name: `run-${i}.csv`, mimeType: 'text/csv',
          buffer: Buffer.alloc(size) })));
    const press = (name) =>
      page.page.getByRole('button', { name, exact: true }).click();
    await pick(800, 2000);
    await press('Check');
    tally.check(await page.untilText('a file has at most', '[role=alert]'),
      'a file that is too large is not sent');
    await pick(800, 400);
    let goOn;
    state.waits = new Promise((resolve) => { goOn = resolve; });
    state.check = { accepted: false, remarks: [`run-0.csv: ${IMAGE}`],
      error: `2 mistakes:\n(1) run-0.csv: line 3 ${SCRIPT}\n(2) more` };
    await press('Check');
    tally.check(await page.untilText('Sending 2 files', '[role=status]'),
      'files that are sent');
    await page.checkAxe('import-sending');
    await press('Cancel');
    tally.check(await page.untilText('Nothing was imported', '[role=status]'),
      'it can be cancelled');
    goOn();
    await press('Check');
    tally.check(await page.untilText(SCRIPT, '.import-answer [role=alert]'),
      'a refusal in trainctl\'s words');
    await page.examine('import-refused', true, 80);
    state.check = { accepted: true, remarks: [IMAGE], result: { trials: 60,
      frames: 6000, counts: { HU: 50, [IMAGE]: 10 }, conditions: 2, groups: 0,
      with_poses: 60, never_felt: 1, duplicates: 0,
      skin: { layout: IMAGE, rows: 16, columns: 24 } } };
    await press('Check');
    tally.check(await page.untilText('Nothing is on the server yet.'),
      'what would be imported');
    await page.checkAxe('import-read');
    await page.page.getByLabel('Into the dataset').selectOption('arm');
    await press('Import');
    tally.check(await page.untilText('this is arm@2 now, with 60 trials'),
      'the new version');
    tally.check(await page.untilText('5 of the trials were there already and ' +
      `were left out: a ${IMAGE} (there as 000017), ...`), 'what was known');
    await page.checkAxe('import-done');
  },

  async 'what evaluations measured'({ page, fake }) {
    Object.assign(fake.answers, trainAnswers());
    await page.page.goto(`${fake.url}#train/model/arm/2`);
    tally.check(await page.untilText('93.0 % (186 of 200; 95 % interval 88.6 ' +
      'to 95.8 %)', '.pairs'), 'the accuracy, with its interval');
    tally.check(await page.untilText('99.0 % (198 of 200; 95 % interval 96.4 ' +
      'to 99.7 %)', '.pairs'), 'that of a question');
    const own = jobsOf().find(({ name }) => name === 'operations/8');
    await checkReliability(page, own.result.evaluation.reliability);
    tally.check(await page.page.locator('.drawing').count() === 3,
      'questions, times, reliability');
    await page.examine('evaluation');
    const choice = page.page.getByLabel('Compare with');
    tally.check((await choice.locator('option').allTextContents()).join() ===
      'Compare with ...,arm@1,k-fold, ridge', 'what it can be compared with');
    await choice.selectOption('arm@1');
    tally.check(await page.untilText('86.0 % (172 of 200'), 'both beside ' +
      'each other');
    tally.check(await page.page.locator('.confusion').count() === 2,
      'two confusion matrices');
    tally.check(await page.page.locator('.drawing').count() === 4,
      'two reliability diagrams');
    await page.examine('evaluations');
    await page.page.goto(`${fake.url}#train/job/9`);
    tally.check(await page.untilText('The gate was passed'), 'a promotion');
    tally.check(await page.page.locator('.confusion').count() === 2 &&
      await page.page.locator('.drawing').count() === 4,
    'has the same of both versions');
    await page.checkAxe('promotion');
  },

  async 'the request id of a job'({ page, fake }) {
    await page.context.grantPermissions(['clipboard-read', 'clipboard-write']);
    Object.assign(fake.answers, trainAnswers());
    await page.page.goto(`${fake.url}#train/job/5`);
    tally.check(await page.untilText('nightly-17', '.pairs'), 'it is there');
    const copy = page.page.getByRole('button', { name: 'Copy request id' });
    await copy.focus();
    await page.page.keyboard.press('Enter');
    tally.check(await page.untilText('The request id is copied.', '#told'),
      'it says so');
    tally.check(await page.page.evaluate(() =>
      navigator.clipboard.readText()) === 'nightly-17', 'the id alone');
    await page.examine('request-id');
    await page.page.evaluate(() => {
      navigator.clipboard.writeText = () => Promise.reject(new Error('no'));
    });
    await copy.click();
    tally.check(await page.untilText('does not let the page copy', '#told'),
      'a browser that does not copy');
    await page.page.goto(`${fake.url}#train/job/8`);
    tally.check(await page.untilText('93.0 % (186 of 200'), 'another job');
    tally.check(await copy.count() === 0, 'without an id');
  },

  async 'an evaluation of an earlier release'({ page, fake }) {
    Object.assign(fake.answers, trainAnswers({ old: true }));
    await page.page.goto(`${fake.url}#train/job/8`);
    tally.check(await page.untilText('A server of an earlier release has ' +
      'evaluated: it measured neither the questions nor the reliability.'),
    'it says what is missing');
    tally.check(await page.untilText('93.0 % (186 of 200'), 'the accuracy');
    tally.check(await page.page.locator('.drawing').count() === 1,
      'the accuracy over time alone');
    await page.page.goto(`${fake.url}#train/model/arm/2`);
    await page.page.getByLabel('Compare with').selectOption('arm@1');
    tally.check(await page.untilText('an earlier release has evaluated arm@2:'),
      'which of two it is');
    tally.check(await page.page.locator('.drawing').count() === 3,
      'the reliability of the other one');
    await page.checkAxe('evaluation-earlier');
  },

  async 'how a server is'({ page, fake }) {
    Object.assign(fake.answers, serverAnswers());
    await page.page.goto(`${fake.url}#server`);
    tally.check(await page.untilText('Serving', '.health'), 'it serves');
    tally.check(await page.page.locator('.reasons').count() === 0,
      'nothing is wrong');
    tally.check(await page.untilText('3 versions, with bundles of 5.27 MiB'),
      'models in memory');
    const rows = (caption) => page.page.locator(
      `[aria-label="${caption}"] tbody tr`).evaluateAll((all) => all.map(
      (row) => [...row.cells].map((cell) => cell.innerText).join(' | ')));
    await page.untilText('bob', 'td');
    const uses = (await rows('Use of quotas by client')).join('; ');
    tally.check(uses === 'ann | 0 of 8 | 2 of 10 | 0 of 4 | 3.52 MiB of ' +
      '64 MiB; bob | 0 of 8 | 0 of 10 | 1 of 4 | 0 B of 64 MiB; robots | ' +
      '2 of 8 | 0 of 10 | 0 of 4 | 0 B of 64 MiB', `quotas: ${uses}`);
    await page.examine('server');

    Object.assign(fake.answers, serverAnswers({ changes: DEGRADED }));
    await page.page.reload();
    tally.check(await page.untilText('Degraded', '.health'), 'it is degraded');
    const reasons = await page.page.locator('.reasons li').allTextContents();
    tally.check(reasons.join('; ') === 'It refuses new streams: all 64 ' +
      'places are taken.; A stored model is not served: ' +
      'models/old/versions/1: BUNDLE_VERSION; The server lab-2:50051 on ' +
      'lab-2 has not been heard of for ten seconds.; The server ' +
      'lab-3:50051 on lab-3 does not serve the newest change of models or ' +
      'aliases yet.', `why: ${reasons.join('; ')}`);
    tally.check((await rows('Servers and workers of this catalogue'))
      .length === 4, 'all servers and workers');
    await page.examine('server-degraded');

    Object.assign(fake.answers, serverAnswers({ status: 'NOT_SERVING' }));
    await page.page.reload();
    tally.check(await page.untilText('Not serving', '.health'), 'it drains');
    await page.checkAxe('server-draining');
  },

  async 'names of strangers'({ page, fake }) {
    fake.robots.push(new FakeRobot(2, SCRIPT), new FakeRobot(3,
      'a-robot-with-a-name-of-128-bytes-'.repeat(4).slice(0, 128), {
        questions: [{ name: IMAGE, kind: 'KIND_STATE',
          values: [SCRIPT, IMAGE, 'averyveryverylongclassname'.repeat(4)] }],
      }));
    await page.page.waitForSelector('[data-robot^="a-robot"]');
    const names = await page.names();
    tally.check(names.includes(IMAGE) && names.includes(SCRIPT), 'all there');
    tally.check((await page.text('.grid')).includes(IMAGE), 'names are text');
    await page.examine('strangers');
    await page.page.click('[data-robot^="a-robot"] a');
    await page.page.waitForSelector('.full');
    await page.untilText('touched', '.events li');
    await page.examine('strangers-full');
    tally.check(await page.page.$$eval('main img, main script',
      (all) => all.length === 0), 'none of them is an element');
  },
};

// Answers of a console to an import of two files. A promise that is set keeps
// the next answer back.
function importAnswers(fake) {
  const state = { waits: undefined, check: undefined };
  const held = (answer) => async () => {
    await state.waits;
    return typeof answer === 'function' ? answer() : answer;
  };
  Object.assign(fake.answers, {
    '/api/servers/0/TrainingService/ListDatasets': () =>
      ({ datasets: [{ name: 'datasets/arm', description: '',
        create_time_ms: '0', latest_version: 1, requester: 'ann' }],
      next_page_token: '' }),
    '/api/servers/0/AdminService/GetServerInfo': () => ({}),
    '/api/import/0/begin': () =>
      ({ id: 'i', file_bytes: 1000, bytes: 1500, files: 3 }),
    '/api/import/0/file': held({ bytes: 1 }),
    '/api/import/0/check': held(() => state.check),
    '/api/import/0/end': () => ({}),
    '/api/import/0/finish': () => ({ accepted: true, remarks: [], result: {
      version: { name: 'datasets/arm/versions/2', trials: 60, added: 55,
        duplicates: 5, relabelled: 0, renamed: 0 },
      notes: [{ kind: 'duplicate', id: '1', source: `a ${IMAGE}`, label: 'HU',
        other_id: '000017', other_source: '', other_label: 'HU',
        new_id: '' }] } }),
  });
  return state;
}

// Each bin has its count in words, and its share of right answers at the height
// of the scale beside it.
async function checkReliability(page, bins) {
  const drawing = page.page.locator('.drawing:has(.bin)');
  const texts = await drawing.locator('text').evaluateAll((all) =>
    all.map((text) => ({ text: text.textContent,
      y: Number(text.getAttribute('y')) })));
  const circles = await drawing.locator('circle').evaluateAll((all) =>
    all.map((circle) => ({ y: Number(circle.getAttribute('cy')),
      isFew: circle.classList.contains('few') })));
  const heightOf = (wanted) => texts.find(({ text }) => text === wanted).y;
  const zero = heightOf('0 %');
  const whole = heightOf('100 %') - zero;
  // Texts of the scale are four units below its lines.
  const expected = bins.map(({ accuracy: { correct, contacts } }) =>
    zero - 4 + whole * correct / contacts);
  tally.check(circles.length === bins.length && circles.every(({ y }, i) =>
    Math.abs(y - expected[i]) < 0.1), `the shares of right answers: ${
    circles.map(({ y }) => y)} are at ${expected}`);
  tally.check(circles.every(({ isFew }, i) =>
    isFew === bins[i].accuracy.contacts < 10), 'bins of few contacts');
  tally.check(bins.every(({ accuracy: { contacts } }) =>
    texts.some(({ text }) => text === String(contacts))), 'counts of bins');
  const heights = await drawing.locator('rect').evaluateAll((all) =>
    all.map((rect) => Number(rect.getAttribute('height'))));
  const most = Math.max(...heights);
  tally.check(heights.every((height, i) => Math.abs(height / most -
    bins[i].accuracy.contacts / 120) < 0.01), `counts drawn: ${heights}`);
}

async function pauseAndScrub(page) {
  const moment = () => page.text('.time');
  await page.page.keyboard.press('Space');
  tally.check(await page.untilText('Go on', '.pause'), 'space pauses');
  const paused = await moment();
  await page.page.waitForTimeout(400);
  tally.check(await moment() === paused, 'the moment stays');
  await page.page.keyboard.press('ArrowLeft');
  const before = await moment();
  tally.check(before < paused, `left steps back (${paused}, ${before})`);
  await page.page.keyboard.press('ArrowRight');
  tally.check(await moment() === paused, 'right steps forward');
  await page.page.focus('.transport input');
  await page.page.keyboard.press('Home');
  tally.check(await moment() < before, 'the slider goes to the first frame');
  const box = await page.page.locator('.chart .u-over').first().boundingBox();
  await page.page.mouse.move(box.x + box.width - 60, box.y + 40);
  await page.page.mouse.down();
  const there = await moment();
  await page.page.mouse.move(box.x + box.width - 20, box.y + 40);
  await page.page.mouse.up();
  tally.check(there < await moment(), 'dragging on a chart goes there');
  await page.page.focus('.skin');
  await page.page.keyboard.press('Space');
  tally.check(await page.untilText('live', '.time'), 'space goes on');
  await page.page.keyboard.press('Space');
}

async function pickTaxels(page) {
  await page.page.focus('.skin');
  await page.page.keyboard.press('ArrowRight');
  await page.page.keyboard.press('ArrowRight');
  await page.page.keyboard.press('ArrowDown');
  tally.check((await page.text('.pick')).startsWith(
    'taxel 25 (row 1, column 1): '), 'arrow keys pick a taxel');
  const box = await page.page.locator('.skin').boundingBox();
  await page.page.mouse.click(box.x + box.width * 2.5 / 24,
    box.y + box.height * 3.5 / 16);
  tally.check((await page.text('.pick')).startsWith(
    'taxel 74 (row 3, column 2): '), 'a click picks a taxel');
}

// In a moment with two contacts.
async function chooseContact(page) {
  await page.page.focus('.transport input');
  for (let i = 0; i < 200 && !await page.page.isVisible('.choice'); ++i) {
    await page.page.keyboard.press('ArrowLeft');
  }
  const second = page.page.locator('.choice button').nth(2);
  const id = await second.innerText();
  await second.click();
  tally.check((await page.text('.answers-title')).startsWith(`contact ${id}, `),
    'a contact can be chosen');
}

// How many robots there are at first.
const ROBOTS = { 'no robot': 0, 'four robots': 4, 'twenty robots': 20 };

await mkdir(pictures, { recursive: true });
const browser = await launchBrowser(['--headless=new'], executablePath);
for (const [name, run] of Object.entries(tests)) {
  if (chosen.length > 0 && !chosen.includes(name)) continue;
  console.log(`  ${name}`);
  const robots = name === 'names of strangers' ?
    [new FakeRobot(1, IMAGE)] : makeRobots(ROBOTS[name] ?? 1);
  const fake = new FakeConsole(pageDir, robots,
    name === 'sign-in' ? { token: 'right' } : {});
  const url = await fake.listen();
  const page = await BrowserPage.open(browser, url, tally, pictures);
  try {
    await run({ page, fake });
    tally.check(!fake.faults, `${name}: one question at a time`);
    await page.close(name);
  } catch (error) {
    tally.check(false, `${name}: ${error.stack}`);
    await page.page.screenshot({ path: `${pictures}/failed.png` });
    await page.context.close();
  }
  await fake.close();
}
await browser.close();
console.log(`${tally.passed} checks passed, ${tally.failed} failed`);
process.exit(tally.failed > 0 ? 1 : 0);
