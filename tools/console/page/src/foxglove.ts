// The address at which Foxglove and Lichtblick see the robots. It holds a key
// that lets whoever has it watch, and do nothing else, until the sign-in ends.

import { readSession } from './connection';
import { element } from './dom';
import { tellDone } from './parts/states';

// A button that copies the address.
export function foxgloveButton(): HTMLElement {
  const button = element('button', { type: 'button' },
    'Copy address for Foxglove');
  button.addEventListener('click', () => void copyAddress());
  return button;
}

async function copyAddress(): Promise<void> {
  let address = '';
  try {
    // The key of now: the person may have signed in anew.
    const { watch_key } = await readSession();
    if (!watch_key) return tellDone('Nobody is signed in any more.');
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    address = `${scheme}://${location.host}/foxglove?key=${watch_key}`;
    await navigator.clipboard.writeText(address);
    tellDone('The address is copied. Whoever has it can watch the robots ' +
      'until you sign out or the console ends.');
  } catch {
    tellDone(address === '' ? 'The console does not answer.' :
      `The browser does not let the page copy. The address is ${address}`);
  }
}
