// The answers to a contact: a bar for each value of each question, and what is
// decided.

import { element, setText } from './dom';
import type { Contact, Question } from './messages';
import { percent, seconds } from './words';

interface Bar {
  row: HTMLElement;
  fill: HTMLElement;
  name: HTMLElement;
  value: string;
  number: HTMLElement;
}

export class AnswersView {
  readonly root: HTMLElement;
  private readonly title = element('p', { class: 'answers-title' });
  private readonly bars: Bar[][] = [];

  constructor(questions: Question[]) {
    this.root = element('div', { class: 'answers' }, this.title);
    for (const question of questions) {
      const rows = question.values.map((value) => this.makeBar(value));
      this.bars.push(rows);
      this.root.append(
        element('div', { class: 'question' },
          element('span', { class: 'question-name' }, question.name),
          element('ul', {}, ...rows.map((bar) => bar.row))));
    }
  }

  // Shows a contact; `felt` false: it is over.
  show(contact: Contact | undefined, felt: boolean): void {
    this.root.classList.toggle('over', !felt);
    setText(this.title, titleOf(contact, felt));
    this.bars.forEach((bars, q) => {
      const answer = contact?.answers[q];
      bars.forEach((bar, v) => {
        const probability = answer?.probability[v] ?? 0;
        const decided = answer?.decision?.value === v &&
          answer.decision !== undefined && answer.decision !== null;
        bar.fill.style.width = `${100 * probability}%`;
        bar.row.classList.toggle('decided', decided);
        setText(bar.name, decided ? `✓ ${bar.value}` : bar.value);
        setText(bar.number, answer ? percent(probability) : '');
      });
    });
  }

  private makeBar(value: string): Bar {
    const fill = element('span', { class: 'fill' });
    const name = element('span', { class: 'value' }, value);
    const number = element('span', { class: 'percent' });
    const row = element('li', {}, name,
      element('span', { class: 'track', 'aria-hidden': 'true' }, fill), number);
    return { row, fill, name, value, number };
  }
}

function titleOf(contact: Contact | undefined, felt: boolean): string {
  if (contact === undefined) return 'no contact yet';
  const unknown = contact.unknown >= 0.5 ?
    `, unknown ${percent(contact.unknown)}` : '';
  const time = seconds(contact.time_since_onset_ns);
  return felt ? `contact ${contact.id}, ${time}${unknown}` :
    `last contact ${contact.id}, ${time}${unknown}`;
}
