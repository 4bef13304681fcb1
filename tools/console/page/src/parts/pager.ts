// The way through the pages of a list whose pages are known by tokens.

import { element } from '../dom';
import { button } from './table';

export class Pager {
  private tokens = [''];

  constructor(private readonly onTurn: () => void) {}

  // Of the page that is shown.
  get token(): string { return this.tokens[this.tokens.length - 1]!; }

  reset(): void { this.tokens = ['']; }

  // `next`: the token of the page that follows; empty if none does.
  view(next: string): HTMLElement {
    const newer = button('← Newer', () => {
      this.tokens.pop();
      this.onTurn();
    });
    const older = button('Older →', () => {
      this.tokens.push(next);
      this.onTurn();
    });
    newer.disabled = this.tokens.length === 1;
    older.disabled = next === '';
    const root = element('div', { class: 'pager' }, newer, older);
    root.hidden = newer.disabled && older.disabled;
    return root;
  }
}
