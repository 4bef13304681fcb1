// The list of contacts: what the filters choose, page by page, and whether
// there are newer ones.

import type { Api } from '../api';
import { element } from '../dom';
import { Pager } from '../parts/pager';
import { emptyBox, Part } from '../parts/states';
import { button } from '../parts/table';
import { bytes, grouped } from '../parts/texts';
import { plural } from '../words';
import type { ContactTable } from './contact_table';
import { isFiltered, requestOf, type Filters } from './filters';
import { lookAgain } from './gone';
import type { ContactList as Response, Logged } from './messages';

const ROWS = 50;
const POLL_MS = 4000;

export interface ListHandlers {
  makeTable: (contacts: Logged[]) => ContactTable;
  // After another page is shown. `end`: it was turned back to.
  onShown: (turned: number) => void;
  onCleared: () => void;
}

export class ContactsList {
  table?: ContactTable;
  private readonly part: Part;
  private readonly pager = new Pager(() => this.load());
  private readonly fresh = button('', () => this.reload());
  private filters?: Filters;
  private turned = 0;
  private newest?: string;
  private timer = 0;
  private closed = false;

  constructor(private readonly api: Api,
      private readonly handlers: ListHandlers, filterBar: HTMLElement) {
    this.fresh.hidden = true;
    this.part = new Part('Contacts', this.fresh);
    this.part.root.classList.add('contact-list');
    this.part.root.insertBefore(filterBar, this.part.root.lastChild);
  }

  get root(): HTMLElement { return this.part.root; }

  show(filters: Filters): void {
    this.filters = filters;
    this.reload();
  }

  reload(): void {
    this.pager.reset();
    this.load();
  }

  // Loads the page anew that is shown.
  load(): void {
    clearTimeout(this.timer);
    const filters = this.filters!;
    void this.part.load(async (signal) => {
      const response = await this.api.call<Response>(
        'ContactLogService/ListContacts', { ...requestOf(filters),
          page_size: ROWS, page_token: this.pager.token, with_pictures: true },
        signal);
      if (signal.aborted) return [];
      const nodes = this.view(response);
      this.fresh.hidden = true;
      const isNewest = filters.order === '' && this.pager.token === '';
      this.newest = isNewest ? response.contacts[0]?.name ?? '' : undefined;
      if (isNewest) this.pollLater();
      else void this.poll().catch(() => undefined).then(() => this.pollLater());
      // After the rows are there: only then can one have the focus.
      setTimeout(() => {
        const { turned } = this;
        this.turned = 0;
        if (!signal.aborted && !this.closed) this.handlers.onShown(turned);
      });
      return nodes;
    });
  }

  // To the next page, or the one before; false if there is none.
  turn(by: number): boolean {
    this.turned = by;
    const turns = by > 0 ? this.pager.turnOn() : this.pager.turnBack();
    if (!turns) this.turned = 0;
    return turns;
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.part.close();
  }

  private view(response: Response): Node[] {
    const { contacts, kept, matching, next_page_token } = response;
    if (contacts.length === 0) {
      this.table = undefined;
      if (kept === 0) {
        return [emptyBox('No contact yet', 'Contacts appear here a moment ' +
          'after they end. Start a simulated robot:',
        `tactus-stream --server=${this.api.address} --driver=sim ` +
          '--rate=real --client-id=arm-1 --trials=1000')];
      }
      if (isFiltered(this.filters!)) {
        const box = emptyBox('No contact is like that',
          `None of ${grouped(kept)} fits.`);
        const clear = button('Show all', () => this.handlers.onCleared());
        box.append(element('div', { class: 'buttons' }, clear));
        return [box];
      }
      return [emptyBox('No contact on this page', 'The log has dropped what ' +
        'was here.'), this.pager.view('')];
    }
    this.table = this.handlers.makeTable(contacts);
    const left = Number(response.left_out);
    const pager = this.pager.view(next_page_token);
    pager.hidden = false;
    pager.prepend(element('p', { class: 'quiet' },
      [`${grouped(matching)} of ${plural(kept, 'kept contact')}`,
        `${bytes(response.bytes)} of ${bytes(response.max_bytes)}`,
        ...(left > 0 ? [`${grouped(left)} could not be kept`] : [])]
        .join(', ')));
    return [this.table.root, pager];
  }

  private pollLater(): void {
    clearTimeout(this.timer);
    if (this.closed) return;
    this.timer = window.setTimeout(() => void this.poll().catch(() =>
      undefined).then(() => this.pollLater()), POLL_MS);
  }

  // Rows stay where they are: somebody may be labelling. What others have
  // labelled is shown, and whether there is more.
  private async poll(): Promise<void> {
    if (document.hidden) return;
    const { table, filters } = this;
    const newest = await this.api.call<Response>(
      'ContactLogService/ListContacts', { ...requestOf(filters!), order: 0,
        page_size: 1 });
    if (filters !== this.filters || this.table !== table) return;
    const name = newest.contacts[0]?.name ?? '';
    if (this.newest !== undefined && name !== this.newest && name !== '') {
      if (!table) return this.load();
      this.fresh.textContent = 'There are newer ones: show';
      this.fresh.hidden = false;
    }
    this.newest ??= name;
    if (!table) return;
    const names = table.contacts.map((contact) => contact.name);
    const now = await lookAgain(this.api, names);
    if (this.table === table) table.renew(now);
  }
}
