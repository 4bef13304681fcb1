// Chooses the contact whose answers are shown: the largest, or one of several.

import { element } from './dom';
import type { FeltContact } from './words';

export class ContactChoice {
  readonly root = element('div', { class: 'choice', role: 'group',
    'aria-label': 'Contact whose answers are shown' });
  // The number of the chosen contact; the largest if undefined.
  private chosen?: string;
  private shown = '';

  constructor(private readonly onChoice: () => void) {
    this.root.hidden = true;
  }

  // The contact to show of those that are felt, the largest first.
  of(felt: FeltContact[]): FeltContact | undefined {
    const chosen = felt.find((contact) => contact.id === this.chosen);
    this.show(felt, chosen);
    return chosen ?? felt[0];
  }

  private show(felt: FeltContact[], chosen?: FeltContact): void {
    const ids = felt.map((contact) => contact.id)
      .sort((a, b) => Number(a) - Number(b));
    const state = `${ids.join()} ${chosen?.id ?? ''}`;
    if (state === this.shown) return;
    this.shown = state;
    this.root.hidden = felt.length < 2;
    // The button that has the focus keeps it.
    const focus = document.activeElement;
    const at = [...this.root.children].indexOf(focus as Element);
    this.root.replaceChildren(
      this.button('largest', chosen === undefined, undefined),
      ...ids.map((id) => this.button(id, id === chosen?.id, id)));
    if (at >= 0) (this.root.children[at] as HTMLElement | undefined)?.focus();
  }

  private button(text: string, pressed: boolean, id?: string): HTMLElement {
    const button = element('button',
      { type: 'button', 'aria-pressed': String(pressed) }, text);
    button.addEventListener('click', () => {
      this.chosen = id;
      this.onChoice();
    });
    return button;
  }
}
