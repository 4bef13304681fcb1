// Labels that were given on the page and are not saved yet. The browser's tab
// keeps them, so that loading the page anew loses none. Each step can be
// undone.

import { newRequestId } from '../api';
import type { ContactLabel, Logged } from './messages';

// As many as a request may have.
export const MOST_DRAFTS = 1000;
const MOST_STEPS = 200;

export interface Draft extends ContactLabel {
  // The log of a server that lost its data gives names anew.
  begin_time_ms: string;
}

interface Kept {
  drafts: Draft[];
  // What each step replaced: [contact, the draft before].
  steps: [string, Draft | null][][];
  dataset: string;
  reason: string;
  // The request that failed last: asked again unchanged, it does its work once.
  tried?: { body: string; id: string };
}

export class Drafts {
  private readonly byContact = new Map<string, Draft>();
  private kept: Kept = { drafts: [], steps: [], dataset: '', reason: '' };
  private readonly key: string;

  // Of one person on one server.
  constructor(server: string, person: string,
      private readonly onChange: () => void) {
    this.key = `labels ${person} ${server}`;
    try {
      const text = sessionStorage.getItem(this.key);
      if (text !== null) this.kept = JSON.parse(text) as Kept;
    } catch {
      // A browser that keeps nothing has none.
    }
    for (const draft of this.kept.drafts) {
      this.byContact.set(draft.contact, draft);
    }
  }

  get size(): number { return this.byContact.size; }
  get steps(): number { return this.kept.steps.length; }
  get dataset(): string { return this.kept.dataset; }
  get reason(): string { return this.kept.reason; }
  get all(): Draft[] { return [...this.byContact.values()]; }

  of({ name, begin_time_ms }: Logged): Draft | undefined {
    const draft = this.byContact.get(name);
    return draft?.begin_time_ms === begin_time_ms ? draft : undefined;
  }

  // Gives labels, or takes them away. False if that were too many.
  set(changes: { contact: Logged; draft?: Omit<ContactLabel, 'contact'> }[]):
      boolean {
    const added = changes.filter(({ contact, draft }) =>
      draft && !this.byContact.has(contact.name)).length;
    if (this.size + added > MOST_DRAFTS) return false;
    const step = changes.map(({ contact }): [string, Draft | null] =>
      [contact.name, this.byContact.get(contact.name) ?? null]);
    for (const { contact, draft } of changes) {
      if (draft) {
        this.byContact.set(contact.name, { ...draft, contact: contact.name,
          begin_time_ms: contact.begin_time_ms });
      } else {
        this.byContact.delete(contact.name);
      }
    }
    this.kept.steps.push(step);
    this.kept.steps.splice(0, this.kept.steps.length - MOST_STEPS);
    this.keep();
    return true;
  }

  // Returns the contacts that are as they were before the last step.
  undo(): string[] {
    const step = this.kept.steps.pop() ?? [];
    for (const [name, draft] of step) {
      if (draft) this.byContact.set(name, draft);
      else this.byContact.delete(name);
    }
    this.keep();
    return step.map(([name]) => name);
  }

  choose(dataset: string, reason: string): void {
    Object.assign(this.kept, { dataset, reason });
    this.keep(false);
  }

  leaveOut(contacts: string[]): void {
    for (const contact of contacts) this.byContact.delete(contact);
    this.kept.steps = [];
    this.keep();
  }

  // The request that saves all.
  request(): object {
    const labels = this.all.map(({ begin_time_ms: _, ...label }) => label);
    const request = { dataset: `datasets/${this.dataset}`,
      reason: this.reason, labels };
    const body = JSON.stringify(request);
    if (this.kept.tried?.body !== body) {
      this.kept.tried = { body, id: newRequestId() };
      this.keep(false);
    }
    return { ...request, request_id: this.kept.tried!.id };
  }

  // After those of a request were saved. Others stay.
  saved(labels: ContactLabel[]): void {
    for (const label of labels) {
      const draft = this.byContact.get(label.contact);
      if (draft?.label === label.label) this.byContact.delete(label.contact);
    }
    this.kept.steps = [];
    this.kept.reason = '';
    this.kept.tried = undefined;
    this.keep();
  }

  private keep(changed = true): void {
    this.kept.drafts = this.all;
    try {
      sessionStorage.setItem(this.key, JSON.stringify(this.kept));
    } catch {
      // They are kept as long as the page is open.
    }
    if (changed) this.onChange();
  }
}
