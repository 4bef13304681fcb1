// Gives labels to the contacts that are chosen.

import { ask } from '../parts/dialog';
import { plural } from '../words';
import { MOST_DRAFTS, type Draft, type Drafts } from './drafts';
import type { ContactLabel, Logged } from './messages';
import { numberOf } from './texts';

export interface LabellerHandlers {
  targets: () => Logged[];
  // With what was done, in words.
  onLabelled: (text: string) => void;
  onRefused: (text: string) => void;
}

export class Labeller {
  // False once the server says that the person may not label.
  mayLabel = true;
  private readonly classes = new Map<string, string[]>();

  constructor(private readonly drafts: Drafts,
      private readonly handlers: LabellerHandlers) {}

  learn(version: string, names: string[]): void {
    if (names.length > 0 && !this.classes.has(version)) {
      this.classes.set(version, [...new Set(names)]);
    }
  }

  // Those of its model, in the order of their keys.
  classesOf({ model_version, label }: Logged): string[] {
    return this.classes.get(model_version) ?? (label ? [label] : []);
  }

  give(label: string, more: Partial<ContactLabel> = {}): void {
    this.set(() => ({ ...more, label, prefilled: false }), label);
  }

  // Takes what was answered.
  confirm(): void {
    this.set(({ label }) => label === '' ? undefined :
      { label, prefilled: true }, 'confirmed');
  }

  clear(): void {
    const targets = this.handlers.targets()
      .filter((contact) => this.drafts.of(contact));
    if (!this.mayLabel || targets.length === 0) return;
    this.drafts.set(targets.map((contact) => ({ contact })));
  }

  askOther(): void {
    const targets = this.handlers.targets();
    if (!this.mayLabel || targets.length === 0) return;
    const known = [...new Set(this.drafts.all.map((draft) => draft.label))];
    ask({
      title: targets.length === 1 ? `Label contact ${numberOf(targets[0]!)}` :
        `Label ${plural(targets.length, 'contact')}`,
      fields: [
        { name: 'label', label: 'Label', required: true, list: known,
          hint: 'A class that the model does not have yet is one of the next ' +
            'model.' },
        { name: 'object', label: 'Object' },
        { name: 'material', label: 'Material' },
        { name: 'condition', label: 'Condition' },
      ],
      action: 'Label',
      run: async ({ label, ...more }) => { this.give(label!, more); },
    });
  }

  private set(draftOf: (contact: Logged) => Omit<ContactLabel, 'contact'> |
      undefined, what: string): void {
    const targets = this.handlers.targets();
    if (!this.mayLabel || targets.length === 0) return;
    const changes = targets.map((contact) =>
      ({ contact, draft: draftOf(contact) as Draft | undefined }))
      .filter(({ draft }) => draft);
    if (changes.length === 0) return;
    if (!this.drafts.set(changes)) {
      return this.handlers.onRefused(`Save first: ${MOST_DRAFTS} labels at ` +
        'once are the most.');
    }
    this.handlers.onLabelled(`${targets.length === 1 ?
      `Contact ${numberOf(targets[0]!)}` :
      plural(targets.length, 'contact')}: ${what}`);
  }
}
