// Debian's Chromium, in which all tests of the page look at it.

import { after } from 'node:test';

import { chromium } from 'playwright-core';

export const optionsOf = (flags = [], executablePath = '/usr/bin/chromium') =>
  ({ executablePath, args: ['--no-sandbox', ...flags] });

export const launchBrowser = (flags, executablePath) =>
  chromium.launch(optionsOf(flags, executablePath));

// The browser of a file of tests. It ends after them, and so do `programs`.
export async function browserOf(programs) {
  const browser = await launchBrowser();
  after(async () => {
    await browser.close();
    await programs.stopAll();
  });
  return browser;
}
