// The buttons that give a label, with the keys that do the same.

import { element, setText } from '../dom';
import { button } from '../parts/table';
import { plural } from '../words';
import type { Logged } from './messages';

export const MOST_KEYS = 9;

export interface LabelHandlers {
  onLabel: (label: string) => void;
  onConfirm: () => void;
  onOther: () => void;
  onClear: () => void;
}

export class LabelTools {
  readonly root: HTMLElement;
  private readonly classes = element('div', { class: 'buttons classes' });
  private readonly whom = element('h3');
  private readonly denied = element('p', { class: 'denied' },
    'Read-only: your role may not label contacts. That needs the role ' +
    'trainer.');
  private readonly confirm: HTMLButtonElement;
  private readonly clear: HTMLButtonElement;
  private readonly other: HTMLButtonElement;
  private mayLabel = true;
  private shown = '';

  constructor(private readonly handlers: LabelHandlers) {
    this.confirm = keyed('Confirm', '↵', 'Enter', handlers.onConfirm, 'main');
    this.clear = keyed('Clear', 'x', 'x', handlers.onClear);
    this.other = button('Other ...', handlers.onOther);
    this.denied.hidden = true;
    this.root = element('div', { class: 'label-tools', role: 'group',
      'aria-label': 'Give a label' }, this.whom, this.classes, this.denied);
  }

  deny(): void {
    this.mayLabel = false;
    this.denied.hidden = false;
    this.classes.hidden = true;
  }

  // `given`: the label of all `targets`, if they have the same.
  show(targets: Logged[], classes: string[], given: string): void {
    const one = targets.length === 1 ? targets[0] : undefined;
    setText(this.whom, !this.mayLabel ? 'Label' : targets.length > 1 ?
      `Label ${plural(targets.length, 'contact')}` : 'Label');
    const confirmed = one?.label ?? '';
    const state = [confirmed, given, targets.length, ...classes].join('\n');
    if (state === this.shown) return;
    this.shown = state;
    setText(this.confirm.lastElementChild!, confirmed ? `Confirm ${confirmed}` :
      'Confirm each');
    this.classes.replaceChildren(...classes.map((name, i) => {
      const tool = i < MOST_KEYS ?
        keyed(name, String(i + 1), String(i + 1),
          () => this.handlers.onLabel(name)) :
        button(name, () => this.handlers.onLabel(name));
      tool.setAttribute('aria-pressed', String(name === given));
      return tool;
    }), this.other, this.confirm, this.clear);
  }
}

function keyed(text: string, key: string, name: string, onClick: () => void,
    kind = ''): HTMLButtonElement {
  const made = button('', onClick, kind);
  made.setAttribute('aria-keyshortcuts', name);
  made.append(element('kbd', { 'aria-hidden': 'true' }, key),
    element('span', {}, text));
  return made;
}
