// The rows of the listed contacts. One of them is the current one, which has
// the focus; several can be picked.

import { element } from '../dom';
import { link, table, type Cell } from '../parts/table';
import { shortName } from '../parts/texts';
import type { Drafts } from './drafts';
import type { Logged } from './messages';
import { answeredCell, answerLine, isDisputed, labelCell, numberOf, robotOf,
  shadowText, timeText } from './texts';
import { thumbnail } from './thumbnail';

interface Row {
  contact: Logged;
  root: HTMLElement;
  link: HTMLAnchorElement;
  box: HTMLInputElement;
  label: HTMLElement;
}

export interface TableHandlers {
  hrefOf: (contact: Logged) => string;
  onCurrent: (contact: Logged) => void;
  onPicked: () => void;
}

export class ContactTable {
  readonly root: HTMLElement;
  private readonly rows: Row[];
  private readonly picked = new Set<string>();
  private current?: string;
  // Where a range of picked rows begins.
  private anchor = -1;

  constructor(contacts: Logged[], private readonly drafts: Drafts,
      private readonly handlers: TableHandlers) {
    const disputed = contacts.some(isDisputed);
    this.rows = contacts.map((contact, i) => this.makeRow(contact, i));
    this.root = table('Contacts', ['', '', 'Contact', 'Answered', 'Questions',
      { title: 'Shadow', optional: true }, 'Label'],
    this.rows.map(({ contact, box, link: way, label }): Cell[] =>
      [box, thumbnail(contact.picture), describe(contact, way),
        answeredCell(contact),
        element('div', { class: 'answer-lines' },
          ...contact.answers.map((answer) => answerLine(answer))),
        disputed && isDisputed(contact) ? shadowText(contact) : '', label]));
    this.root.querySelectorAll<HTMLElement>('tbody tr').forEach((root, i) => {
      const row = this.rows[i]!;
      row.root = root;
      root.dataset.contact = numberOf(row.contact);
      root.addEventListener('click', (event) => this.onClick(event, i));
    });
    this.mark();
  }

  get contacts(): Logged[] { return this.rows.map(({ contact }) => contact); }

  // Those that a label is for: the picked ones, or the current one.
  get targets(): Logged[] {
    const picked = this.rows.filter(({ contact }) =>
      this.picked.has(contact.name));
    const rows = picked.length > 0 ? picked :
      this.rows.filter(({ contact }) => contact.name === this.current);
    return rows.map(({ contact }) => contact);
  }

  get pickedCount(): number { return this.picked.size; }

  get at(): number {
    return this.rows.findIndex(({ contact }) => contact.name === this.current);
  }

  // Makes a row the current one; -1 for none.
  choose(at: number, focus: boolean): void {
    const row = this.rows[at];
    this.current = row?.contact.name;
    this.mark();
    if (!row) return;
    if (focus) row.link.focus({ preventScroll: true });
    this.scrollTo(row);
  }

  // Goes to another row, picking what lies between; false if there is none.
  move(step: number, pick: boolean): boolean {
    const at = this.at;
    const next = at < 0 ? (step > 0 ? 0 : this.rows.length - 1) : at + step;
    if (!this.rows[next]) return false;
    if (pick) this.pickRange(at, next);
    else this.anchor = -1;
    this.choose(next, true);
    this.handlers.onCurrent(this.rows[next]!.contact);
    return true;
  }

  // The first row without a label, from a row on; -1 if there is none.
  nextUnlabelled(from: number): number {
    return this.rows.findIndex(({ contact }, i) => i >= from &&
      !contact.given && !this.drafts.of(contact));
  }

  unpick(): void {
    this.picked.clear();
    this.anchor = -1;
    this.mark();
    this.handlers.onPicked();
  }

  // Takes what the server says about the listed contacts now. Those that it
  // does not have any more are gone.
  renew(contacts: Logged[]): void {
    const now = new Map(contacts.map((contact) => [contact.name, contact]));
    for (const row of this.rows) {
      const fresh = now.get(row.contact.name);
      if (fresh?.begin_time_ms === row.contact.begin_time_ms) {
        row.contact.given = fresh.given;
      } else {
        row.root.classList.add('is-gone');
        row.root.title = 'The log has dropped this contact since.';
      }
    }
    this.showLabels();
  }

  showLabels(): void {
    for (const row of this.rows) {
      const label = labelCell(row.contact, this.drafts.of(row.contact));
      if (label.textContent !== row.label.textContent) {
        row.label.replaceChildren(...label.childNodes);
      }
    }
  }

  private makeRow(contact: Logged, i: number): Row {
    const number = numberOf(contact);
    const way = link(this.handlers.hrefOf(contact), '');
    way.append(element('span', { class: 'unseen' }, `Contact ${number}, `),
      timeText(contact.begin_time_ms));
    const box = element('input', { type: 'checkbox',
      'aria-label': `Pick contact ${number}` });
    // The row's click would come as well.
    box.addEventListener('click', (event) => {
      event.stopPropagation();
      if (event.shiftKey && this.at >= 0) this.pickRange(this.at, i);
      else this.setPicked(i, box.checked);
      this.mark();
      this.handlers.onPicked();
    });
    return { contact, link: way, box, root: box,
      label: labelCell(contact, this.drafts.of(contact)) };
  }

  private onClick(event: MouseEvent, i: number): void {
    // A way into another tab.
    if (event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (event.shiftKey) {
      this.pickRange(this.at < 0 ? i : this.at, i);
      getSelection()?.removeAllRanges();
    }
    this.choose(i, true);
    this.handlers.onCurrent(this.rows[i]!.contact);
  }

  private setPicked(i: number, is: boolean): void {
    const { name } = this.rows[i]!.contact;
    if (is) this.picked.add(name);
    else this.picked.delete(name);
  }

  // From where the range began to `to`; what was picked before it goes.
  private pickRange(from: number, to: number): void {
    if (this.anchor < 0) this.anchor = Math.max(from, 0);
    this.picked.clear();
    const [low, high] = [Math.min(this.anchor, to), Math.max(this.anchor, to)];
    for (let i = low; i <= high; ++i) this.setPicked(i, true);
    this.handlers.onPicked();
  }

  // One stop of the tab key in all rows.
  private mark(): void {
    const at = Math.max(this.at, 0);
    this.rows.forEach(({ contact, root, link: way, box }, i) => {
      const isCurrent = contact.name === this.current;
      root.classList.toggle('is-current', isCurrent);
      root.classList.toggle('is-picked', this.picked.has(contact.name));
      box.checked = this.picked.has(contact.name);
      box.tabIndex = way.tabIndex = i === at ? 0 : -1;
      if (isCurrent) way.setAttribute('aria-current', 'true');
      else way.removeAttribute('aria-current');
    });
  }

  // Within the table alone: the page stays where it is, if the row is in sight.
  private scrollTo({ root }: Row): void {
    const box = this.root.getBoundingClientRect();
    const row = root.getBoundingClientRect();
    const head = this.root.querySelector('thead')!.offsetHeight;
    if (row.top < box.top + head) {
      this.root.scrollTop -= box.top + head - row.top;
    } else if (row.bottom > box.bottom) {
      this.root.scrollTop += row.bottom - box.bottom;
    }
    const seen = root.getBoundingClientRect();
    if (seen.top < 0 || seen.bottom > innerHeight) {
      root.scrollIntoView({ block: 'center' });
    }
  }
}

function describe(contact: Logged, way: HTMLElement): HTMLElement {
  return element('div', { class: 'contact-cell' }, way,
    element('span', { class: 'robot' }, robotOf(contact)),
    element('span', { class: 'quiet' }, shortName(contact.model_version)));
}
