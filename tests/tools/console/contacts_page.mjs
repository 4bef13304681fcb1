// The console's page of contacts in a browser, for tests.

import assert from 'node:assert/strict';

import { BrowserPage } from './browser_page.mjs';

const tally = { check: (condition, text) => assert.ok(condition, text) };

export class ContactsPage {
  static async open(browser, url) {
    return new ContactsPage(await BrowserPage.open(browser, url, tally, '.'));
  }

  constructor(shown) { this.shown = shown; }

  get page() { return this.shown.page; }

  until(condition, argument) { return this.shown.until(condition, argument); }

  async see(text, selector) {
    assert.ok(await this.shown.untilText(text, selector),
      `"${text}" is not there; but:\n${await this.shown.text()}`);
  }

  // What a job takes minutes for.
  async seeSlowly(text, selector) {
    for (let tries = 0; tries < 12; ++tries) {
      if (await this.shown.untilText(text, selector)) return;
    }
    await this.see(text, selector);
  }

  // The page of a job that was just requested, until it has done its work.
  async untilJobDone() {
    await this.see('is requested.', '#told');
    assert.ok(await this.until(() => location.hash.includes('/job/')));
    for (let tries = 0; tries < 12; ++tries) {
      if (await this.until(() => /succeeded|failed|cancelled/.test(
        document.querySelector('.state')?.innerText ?? ''))) break;
    }
    await this.see('succeeded', '.state');
  }

  // Those that the digits 1, 2, ... give.
  classes() {
    return this.page.$$eval('.classes [aria-keyshortcuts]', (tools) =>
      tools.filter((tool) => /^\d$/.test(tool.ariaKeyShortcuts ??
        tool.getAttribute('aria-keyshortcuts')))
        .map((tool) => tool.lastElementChild.innerText));
  }

  press(name) {
    return this.page.getByRole('button', { name, exact: true }).click();
  }

  // What is in the list.
  rows() {
    return this.page.$$eval('[data-contact]', (rows) => rows.map((row) => {
      const text = (selector) => row.querySelector(selector)?.innerText ?? '';
      return { number: row.dataset.contact, robot: text('.robot'),
        answered: text('.answered .value'),
        percent: parseInt(text('.answered .percent'), 10),
        draft: text('.draft'), given: text('.given') };
    }));
  }

  async untilRows(condition, argument) {
    for (let tries = 0; tries < 400; ++tries) {
      if (condition(await this.rows(), argument)) return true;
      await this.page.waitForTimeout(50);
    }
    return false;
  }

  // Until the log has so many, which it writes a moment after they end.
  async reloadUntil(count) {
    for (let tries = 0; tries < 40; ++tries) {
      await this.page.reload();
      assert.ok(await this.untilRows((rows) => rows.length > 0));
      if ((await this.rows()).length >= count) return;
    }
    assert.fail(`fewer than ${count} contacts`);
  }

  // Until the frames of the open contact are there.
  async untilPlayable() {
    assert.ok(await this.until(() => document.querySelector(
      '.contact-view:not([aria-busy]) .opinions') !== null));
  }

  // The number of the contact that has the focus.
  current() {
    return this.page.evaluate(() =>
      document.activeElement.closest('[data-contact]')?.dataset.contact);
  }

  async examine(state) {
    await this.page.evaluate(() => window.scrollTo(0, 0));
    await this.shown.examine(state, true, 80);
  }

  checkAxe(state) { return this.shown.checkAxe(state); }

  close() { return this.shown.close('contacts'); }
}
