// A value with a button that copies it, such as an id to look for in a log.

import { element } from '../dom';
import { tellDone } from './states';
import { button } from './table';

// `name`: what the value is, as in "Copy request id".
export function copiedValue(name: string, value: string): HTMLElement {
  const copy = button('Copy', () => void copyValue(name, value));
  copy.setAttribute('aria-label', `Copy ${name}`);
  return element('span', { class: 'copied-value' },
    element('code', {}, value), copy);
}

async function copyValue(name: string, value: string): Promise<void> {
  try {
    // Browsers have no clipboard for pages that came without TLS.
    await navigator.clipboard.writeText(value);
    tellDone(`The ${name} is copied.`);
  } catch {
    tellDone(`The browser does not let the page copy the ${name}. Select it ` +
      'instead.');
  }
}
