// The contacts page: what robots have touched, what was answered, and labels
// for it. One contact is open beside the list.

import { listAll } from '../api';
import { byId, element, setText } from '../dom';
import type { Page, PageContext, PageKind } from '../page';
import { pageHead } from '../parts/table';
import { shortName } from '../parts/texts';
import type { ModelVersion } from '../wire';
import { percent } from '../words';
import { ContactsList } from './contact_list';
import { ContactTable } from './contact_table';
import { ContactView } from './contact_view';
import { Drafts } from './drafts';
import { FilterBar } from './filter_bar';
import { addressOfFilters, filtersOf, noFilters, type Filters } from
  './filters';
import { keysText, onKey } from './keys';
import { LabelBar } from './label_bar';
import { LabelTools } from './label_tools';
import { Labeller } from './labeller';
import type { ContactList, Logged } from './messages';
import { numberOf } from './texts';

export const CONTACTS: PageKind = {
  id: 'contacts',
  title: 'Contacts',
  ofOneServer: true,
  open: (context) => new ContactsPage(context),
};

class ContactsPage implements Page {
  private readonly root: HTMLElement;
  private readonly filterBar = new FilterBar((filters) => this.go(filters));
  private readonly list: ContactsList;
  private readonly view: ContactView;
  private readonly bar: LabelBar;
  private readonly tools: LabelTools;
  private readonly labeller: Labeller;
  private readonly drafts: Drafts;
  private filters = noFilters();
  private current?: Logged;
  // That of the address, until it is there.
  private wanted?: string;
  private shownFor = '';

  constructor(private readonly context: PageContext) {
    const { api, main } = context;
    this.drafts = new Drafts(api.address, api.person, () => this.showLabels());
    this.labeller = new Labeller(this.drafts, {
      targets: () => this.targets,
      onLabelled: (texts) => this.onLabelled(texts),
      onRefused: (text) =>
        this.bar.tell(element('p', { class: 'error' }, text)),
    });
    this.tools = new LabelTools({
      onLabel: (label) => this.labeller.give(label),
      onConfirm: () => this.labeller.confirm(),
      onOther: () => this.labeller.askOther(),
      onClear: () => this.labeller.clear(),
    });
    this.list = new ContactsList(api, {
      makeTable: (contacts) => this.makeTable(contacts),
      onShown: (turned) => this.onShown(turned),
      onCleared: () => this.go({ ...noFilters(), order: this.filters.order }),
    }, this.filterBar.root);
    this.view = new ContactView(api, this.tools.root, (version, names) => {
      this.labeller.learn(version, names);
      this.showLabels();
    });
    this.bar = new LabelBar(api, this.drafts, () => this.undo(),
      () => this.list.load());
    this.root = element('div', { class: 'page contacts' },
      pageHead('Contacts', undefined, keysText()), this.bar.root,
      element('div', { class: 'contact-columns' }, this.list.root,
        this.view.root));
    main.replaceChildren(this.root);
    window.addEventListener('keydown', this.onKey);
    this.readModels();
    void api.may('trainer').then((may) => {
      if (may !== false) return;
      this.labeller.mayLabel = false;
      this.tools.deny();
      this.bar.root.remove();
    });
  }

  show(path: string[]): void {
    const { open, filters } = filtersOf(path);
    this.wanted = open;
    const address = addressOfFilters(0, filters);
    this.filters = filters;
    this.filterBar.show(filters);
    // Another contact of the same list.
    if (address === this.shownFor) return void this.onShown(0);
    this.shownFor = address;
    this.list.show(filters);
  }

  close(): void {
    window.removeEventListener('keydown', this.onKey);
    this.list.close();
    this.view.close();
  }

  private get targets(): Logged[] {
    const targets = this.list.table?.targets ?? [];
    return targets.length > 0 || !this.current ? targets : [this.current];
  }

  private go(filters: Filters): void {
    location.hash = addressOfFilters(this.context.api.server, filters);
  }

  private readModels(): void {
    const { api } = this.context;
    listAll<ModelVersion>(api, 'ModelService/ListModelVersions', 'versions')
      .then((versions) => {
        const names = versions.map(({ name }) => shortName(name));
        for (const { name, class_names } of versions) {
          this.labeller.learn(name, class_names);
        }
        this.view.setVersions(names);
        this.filterBar.suggest({ versions: names, classes:
          [...new Set(versions.flatMap((of) => of.class_names))] });
        this.showLabels();
      }, () => undefined);
  }

  private makeTable(contacts: Logged[]): ContactTable {
    this.filterBar.note(contacts);
    return new ContactTable(contacts, this.drafts, {
      hrefOf: (contact) => addressOfFilters(this.context.api.server,
        this.filters, numberOf(contact)),
      onCurrent: (contact) => this.open(contact),
      onPicked: () => this.showLabels(),
    });
  }

  // Opens what the address names, what was open, or the first one.
  private onShown(turned: number): void {
    const { table } = this.list;
    this.bar.setUseful(table !== undefined);
    if (!table) {
      this.view.close();
      this.current = undefined;
      if (this.wanted) void this.openStranger(this.wanted);
      return;
    }
    const { contacts } = table;
    const name = this.wanted ? `contacts/${this.wanted}` : this.current?.name;
    let at = contacts.findIndex((contact) => contact.name === name);
    if (turned !== 0) at = turned > 0 ? 0 : contacts.length - 1;
    else if (at < 0 && this.wanted) return void this.openStranger(this.wanted);
    else if (at < 0) at = 0;
    this.wanted = undefined;
    table.choose(at, turned !== 0 || document.activeElement === byId('main') ||
      document.activeElement === document.body);
    this.open(contacts[at]!);
  }

  // A contact that is not on the page of the list.
  private async openStranger(number: string): Promise<void> {
    this.wanted = undefined;
    try {
      const { contacts } = await this.context.api.call<ContactList>(
        'ContactLogService/ListContacts',
        { names: [`contacts/${number}`], with_pictures: true });
      if (contacts[0]) return this.open(contacts[0]);
      this.bar.tell(element('p', { class: 'error' },
        `The log does not have contact ${number} (any more).`));
    } catch {
      // The list says what is wrong.
    }
    if (this.list.table) this.onShown(0);
  }

  private open(contact: Logged): void {
    this.current = contact;
    const { api } = this.context;
    // Going through the list is no way back through the browser's history.
    history.replaceState(null, '', addressOfFilters(api.server, this.filters,
      numberOf(contact)));
    this.view.open(contact);
    this.showLabels();
  }

  private showLabels(): void {
    this.list.table?.showLabels();
    this.bar?.show();
    const { targets } = this;
    const labels = new Set(targets.map((contact) =>
      this.drafts.of(contact)?.label ?? contact.given?.label ?? ''));
    const classes = this.current ? this.labeller.classesOf(this.current) : [];
    this.tools?.show(targets, classes,
      labels.size === 1 ? [...labels][0]! : '');
  }

  // Goes on to what has no label yet.
  private onLabelled(text: string): void {
    this.bar.tell();
    const { table } = this.list;
    table?.unpick();
    let next = table?.nextUnlabelled(table.at) ?? -1;
    if (next < 0 && table && !this.list.turn(1)) {
      next = table.nextUnlabelled(0);
      if (next < 0) table.choose(table.at, true);
    }
    const contact = next < 0 ? undefined : table?.contacts[next];
    if (contact) {
      table!.choose(next, true);
      this.open(contact);
    }
    this.say(text);
  }

  private undo(): void {
    const names = this.drafts.undo();
    if (names.length === 0) return;
    this.bar.tell();
    const { table } = this.list;
    const at = table?.contacts.findIndex(({ name }) => name === names[0]) ?? -1;
    if (table && at >= 0) {
      table.choose(at, true);
      this.open(table.contacts[at]!);
    }
    this.say(`Undone: ${names.map((name) => shortName(name)).join(', ')}`);
  }

  private move(step: number, pick: boolean): void {
    const { table } = this.list;
    if (!table || table.move(step, pick)) return this.say('');
    if (!pick) this.list.turn(step);
  }

  // What was done, and what is the current contact now.
  private say(done: string): void {
    const { current } = this;
    const now = current ? `Contact ${numberOf(current)}, answered ` +
      `${current.label} ${percent(current.confidence)}` : '';
    setText(byId('spoken'), done ? `${done}. ${now}` : now);
  }

  private readonly onKey = (event: KeyboardEvent): void => onKey(event, {
    move: (step, pick) => this.move(step, pick),
    label: (index) => {
      const name = this.current &&
        this.labeller.classesOf(this.current)[index];
      if (name !== undefined) this.labeller.give(name);
    },
    confirm: () => this.labeller.confirm(),
    clear: () => this.labeller.clear(),
    undo: () => { if (this.labeller.mayLabel) this.undo(); },
    play: () => this.view.togglePlay(),
    step: (by) => this.view.step(by),
    leave: () => this.list.table?.unpick(),
  });
}
