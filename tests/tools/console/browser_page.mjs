// The console's page in a browser, and what is true of it in every state: no
// script of a stranger, no request to another host, nothing that the content
// policy forbids, no grave finding of axe, no horizontal scroll bar.

import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const AXE = await readFile(
  createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const WIDTHS = [1440, 1024, 768];
const HEIGHT = 900;
const MOST_TRIES = 400;

export class BrowserPage {
  static async open(browser, url, tally, shots) {
    const context = await browser.newContext(
      { viewport: { width: WIDTHS[0], height: HEIGHT } });
    const page = await context.newPage();
    const opened = new BrowserPage(context, page, new URL(url), tally, shots);
    await page.addInitScript(() => {
      window.violations = [];
      document.addEventListener('securitypolicyviolation', (event) =>
        window.violations.push(
          `${event.violatedDirective} ${event.blockedURI}`));
    });
    await page.goto(url);
    return opened;
  }

  constructor(context, page, url, tally, shots) {
    this.context = context;
    this.page = page;
    this.tally = tally;
    this.shots = shots;
    this.strangers = [];
    this.errors = [];
    page.on('request', (request) => {
      if (new URL(request.url()).host !== url.host) {
        this.strangers.push(request.url());
      }
    });
    page.on('pageerror', (error) => this.errors.push(error.message));
  }

  // The text of what is seen.
  text(selector = 'body') { return this.page.innerText(selector); }

  names() {
    return this.page.$$eval('[data-robot]', (tiles) =>
      tiles.map((tile) => tile.dataset.robot));
  }

  // Waits until a function of the page is true; false if it never is. Asks from
  // outside, because the content policy forbids what waitForFunction does.
  async until(condition, argument) {
    for (let tries = 0; tries < MOST_TRIES; ++tries) {
      if (await this.page.evaluate(condition, argument)) return true;
      await this.page.waitForTimeout(50);
    }
    return false;
  }

  untilText(text, selector = 'body') {
    return this.until(([wanted, where]) => [...document.querySelectorAll(where)]
      .some((node) => node.innerText.includes(wanted)), [text, selector]);
  }

  // Checks a state in light and dark, at three widths, and keeps pictures.
  // `settles`: milliseconds for what moves.
  async examine(state, fullPage = true, settles = 400) {
    for (const colorScheme of ['light', 'dark']) {
      await this.page.emulateMedia({ colorScheme });
      await this.checkAxe(`${state}, ${colorScheme}`);
      for (const width of WIDTHS) {
        await this.page.setViewportSize({ width, height: HEIGHT });
        await this.page.waitForTimeout(settles);
        const over = await this.page.evaluate(() =>
          document.documentElement.scrollWidth - window.innerWidth);
        this.tally.check(over <= 0, `${state}: no horizontal scroll at ` +
          `${width} px (${over} px too wide)`);
        await this.page.screenshot({ fullPage,
          path: join(this.shots, `${state}-${width}-${colorScheme}.png`) });
      }
      await this.page.setViewportSize({ width: WIDTHS[0], height: HEIGHT });
    }
    await this.page.emulateMedia({ colorScheme: 'light' });
  }

  async checkAxe(state) {
    await this.page.evaluate(AXE);
    const { violations } = await this.page.evaluate(() => window.axe.run());
    const grave = violations.filter(({ impact }) =>
      impact === 'serious' || impact === 'critical');
    const texts = grave.map(({ id, nodes }) =>
      `${id} ${nodes.map(({ html }) => html.slice(0, 90)).join(' | ')}`);
    this.tally.check(grave.length === 0, `${state}: axe finds nothing grave` +
      texts.map((text) => `\n      ${text}`).join(''));
  }

  async close(name) {
    const { violations, hacked } = await this.page.evaluate(() =>
      ({ violations: window.violations, hacked: window.hacked }));
    this.tally.check(violations.length === 0,
      `${name}: the policy forbids nothing ${violations.join()}`);
    this.tally.check(hacked === undefined, `${name}: no foreign script ran`);
    this.tally.check(this.strangers.length === 0,
      `${name}: no request to another host ${this.strangers.join()}`);
    this.tally.check(this.errors.length === 0,
      `${name}: no error ${this.errors.join()}`);
    await this.context.close();
  }
}
