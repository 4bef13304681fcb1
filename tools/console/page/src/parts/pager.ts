// The way through the pages of a list whose pages are known by tokens.

import { element } from '../dom';
import { button } from './table';

export class Pager {
  private tokens = [''];
  private next = '';

  constructor(private readonly onTurn: () => void,
      private readonly back = '← Newer', private readonly on = 'Older →') {}

  // Of the page that is shown.
  get token(): string { return this.tokens[this.tokens.length - 1]!; }

  reset(): void { this.tokens = ['']; }

  // False if there is no page before.
  turnBack(): boolean {
    if (this.tokens.length === 1) return false;
    this.tokens.pop();
    this.onTurn();
    return true;
  }

  // False if no page follows.
  turnOn(): boolean {
    if (this.next === '') return false;
    this.tokens.push(this.next);
    // Not twice, before the page is there.
    this.next = '';
    this.onTurn();
    return true;
  }

  // `next`: the token of the page that follows; empty if none does.
  view(next: string): HTMLElement {
    this.next = next;
    const newer = button(this.back, () => void this.turnBack());
    const older = button(this.on, () => void this.turnOn());
    newer.disabled = this.tokens.length === 1;
    older.disabled = next === '';
    const root = element('div', { class: 'pager' }, newer, older);
    root.hidden = newer.disabled && older.disabled;
    return root;
  }
}
