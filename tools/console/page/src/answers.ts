// The answers to a contact: a bar for each value of each question, and what is
// decided.

import { element, setText } from './dom';
import type { Contact, Question, QuestionAnswer } from './messages';
import { isUnknown, percent, quantity, seconds } from './words';

interface Bar {
  root: HTMLElement;
  name: HTMLElement;
  number: HTMLElement;
  fill: HTMLElement;
}

interface Row {
  question: Question;
  bars: Bar[];
}

export class AnswersView {
  readonly root: HTMLElement;
  private readonly title = element('p', { class: 'answers-title' });
  private readonly unknown = element('p', { class: 'unknown' });
  private readonly rows: Row[];

  // Of a question with more values than `most`, the most probable are shown.
  constructor(questions: Question[], private readonly unit: string,
      most: number) {
    this.root = element('div', { class: 'answers' },
      element('div', { class: 'answers-head' }, this.title, this.unknown));
    this.rows = questions.map((question) => {
      const bars = question.values.slice(0, most).map(() => makeBar());
      const more = question.values.length - bars.length;
      const name = more > 0 ?
        `${question.name} (${most} of ${question.values.length})` :
        question.name;
      this.root.append(
        element('div', { class: 'question' },
          element('h3', {}, name),
          element('ul', {}, ...bars.map((bar) => bar.root))));
      return { question, bars };
    });
  }

  // Shows a contact; `felt` false: it is over. `others`: how many more there
  // are.
  show(contact: Contact | undefined, felt: boolean, others: number): void {
    this.root.classList.toggle('over', !felt);
    setText(this.title, titleOf(contact, felt, others, this.unit));
    const strange = contact !== undefined && isUnknown(contact);
    this.root.classList.toggle('is-unknown', strange);
    setText(this.unknown,
      strange ? `? unknown ${percent(contact.unknown)}` : '');
    this.rows.forEach((row, q) => showRow(row, contact?.answers[q]));
  }
}

function makeBar(): Bar {
  const name = element('span', { class: 'value' });
  const number = element('span', { class: 'percent' });
  const fill = element('span', { class: 'fill' });
  const root = element('li', {}, name, number,
    element('span', { class: 'track', 'aria-hidden': 'true' }, fill));
  return { root, name, number, fill };
}

function showRow({ question, bars }: Row, answer?: QuestionAnswer): void {
  const probability = answer?.probability ?? [];
  const order = question.values.map((_, value) => value);
  if (bars.length < order.length) {
    order.sort((a, b) => (probability[b] ?? 0) - (probability[a] ?? 0));
  }
  const decided = answer?.decision?.value;
  bars.forEach((bar, i) => {
    const value = order[i]!;
    const p = probability[value] ?? 0;
    const name = question.values[value]!;
    bar.root.classList.toggle('decided', value === decided);
    bar.fill.style.transform = `scaleX(${Math.min(Math.max(p, 0), 1)})`;
    setText(bar.name, value === decided ? `✓ ${name}` : name);
    setText(bar.number, answer ? percent(p) : '–');
  });
}

function titleOf(contact: Contact | undefined, felt: boolean, others: number,
    unit: string): string {
  if (contact === undefined) return 'no contact yet';
  if (!felt) return `no contact (last: ${contact.id})`;
  const parts = [`contact ${contact.id}`,
    seconds(contact.time_since_onset_ns, 1)];
  if (contact.patch) parts.push(quantity(contact.patch.force, unit));
  if (others > 0) parts.push(`${others} more`);
  return parts.join(', ');
}
