// The keys of the contacts page.

import { element } from '../dom';
import { MOST_KEYS } from './label_tools';

export interface KeyHandlers {
  // Through the list; `pick`: what lies between is picked.
  move: (step: number, pick: boolean) => void;
  label: (index: number) => void;
  confirm: () => void;
  clear: () => void;
  undo: () => void;
  play: () => void;
  // Through the frames of the contact.
  step: (by: number) => void;
  leave: () => void;
}

export function onKey(event: KeyboardEvent, on: KeyHandlers): void {
  const { key, target, shiftKey } = event;
  if (event.ctrlKey || event.altKey || event.metaKey ||
      document.querySelector('dialog[open]')) {
    return;
  }
  const node = target as HTMLElement;
  const isSlider = node instanceof HTMLInputElement && node.type === 'range';
  const isBox = node instanceof HTMLInputElement && node.type === 'checkbox';
  const isField = node instanceof HTMLSelectElement ||
    (node instanceof HTMLInputElement && !isSlider && !isBox);
  if (isField) return;
  // Buttons and links elsewhere do what they are for.
  const isTool = node instanceof HTMLButtonElement ||
    (node instanceof HTMLAnchorElement && !node.closest('[data-contact]'));
  const digit = /^[1-9]$/.test(key) ? Number(key) : 0;
  if (digit >= 1 && digit <= MOST_KEYS && !shiftKey) on.label(digit - 1);
  else if (key === 'ArrowDown' || key === 'j' || key === 'J') {
    if (isSlider && key === 'ArrowDown') return;
    on.move(1, shiftKey);
  } else if (key === 'ArrowUp' || key === 'k' || key === 'K') {
    if (isSlider && key === 'ArrowUp') return;
    on.move(-1, shiftKey);
  } else if (key === 'Enter' && !isTool) on.confirm();
  else if (key === 'x') on.clear();
  else if (key === 'u') on.undo();
  else if (key === ' ' && !isTool && !isBox) on.play();
  else if (key === 'ArrowLeft' && !isSlider) on.step(-1);
  else if (key === 'ArrowRight' && !isSlider) on.step(1);
  else if (key === 'Escape') on.leave();
  else return;
  event.preventDefault();
}

const KEYS: [string, string][] = [
  ['↑ ↓', 'other contact'], ['⇧ ↑ ↓', 'pick several'], ['1 – 9', 'label'],
  ['↵', 'confirm the answer'], ['x', 'clear'], ['u', 'undo'],
  ['Space', 'play'], ['← →', 'frame by frame'],
];

export function keysText(): HTMLElement {
  return element('ul', { class: 'keys quiet', 'aria-label': 'Keys' },
    ...KEYS.map(([key, what]) => element('li', {},
      element('kbd', {}, key), what)));
}
