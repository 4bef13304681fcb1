// What was answered to a contact, beside what a model answers to it now.

import { element } from '../dom';
import { facts, table, type Cell } from '../parts/table';
import { shortName } from '../parts/texts';
import { percent, seconds } from '../words';
import type { Logged, Replayed } from './messages';
import { answerLine, isDisputed, shadowText } from './texts';

// `other`: another model than the one that answered was asked.
export function opinionTable(replayed: Replayed, other: boolean): HTMLElement {
  const { contact, replayed: again, started } = replayed;
  const isSame = !other && replayed.same_answers;
  const columns: Logged[] = [contact, ...(again && !isSame ? [again] : [])];
  const questions = [...new Set(columns.flatMap(({ answers }) =>
    answers.map(({ question }) => question)))];
  const row = (title: string, cellOf: (of: Logged) => Cell): Cell[] => {
    const cells = columns.map(cellOf);
    const differs = cells.length > 1 && textOf(cells[0]!) !== textOf(cells[1]!);
    return [element('span', { class: 'quiet' }, title), cells[0]!,
      ...cells.slice(1).map((cell) => differs ?
        element('span', { class: 'differs' }, cell) : cell)];
  };
  const rows = [
    row('class', ({ label, confidence }) =>
      `${label} ${percent(confidence)}`),
    ...questions.map((name) => row(name, ({ answers }) => {
      const answer = answers.find(({ question }) => question === name);
      return answer ? answerLine(answer, false) : '–';
    })),
    row('unknown', ({ unknown }) => percent(unknown)),
  ];
  const model = shortName(started.model_version);
  const titles = ['', `Answered by ${shortName(contact.model_version)}`,
    ...(columns.length > 1 ?
      [other ? `Answers of ${model}` : 'Answers of the replay'] : [])];
  return element('div', { class: 'opinions' },
    table('What was answered', titles, rows), verdict(replayed, other, model));
}

function verdict(replayed: Replayed, other: boolean, model: string):
    HTMLElement {
  const { contact, replayed: again, same_answers } = replayed;
  if (!again) {
    return element('p', { class: 'warn' },
      `${model} finds no such contact in these frames.`);
  }
  if (other) {
    return element('p', { class: 'quiet' }, again.label === contact.label ?
      'Both answer the same class.' : 'They answer different classes.');
  }
  if (same_answers) {
    return element('p', { class: 'same' },
      'The replay has the same answers, bit for bit.');
  }
  return element('p', { class: contact.exact ? 'warn' : 'quiet' },
    'The replay has other answers' + (contact.exact ? '.' : contact.cut ?
      ': the last frames of this long contact are not kept.' :
      ': what came before the kept frames had a part in the answers.'));
}

function textOf(cell: Cell): string {
  return typeof cell === 'string' ? cell : cell.textContent ?? '';
}

export function contactFacts(contact: Logged): HTMLElement {
  const more: [string, Cell][] = [];
  if (contact.together > 1) {
    more.push(['Together with', `${contact.together - 1} more at the same ` +
      'time']);
  }
  if (contact.cut) more.push(['Kept', 'without its last frames: it is long']);
  if (contact.shadow) {
    const { model_version } = contact.shadow;
    more.push([`Shadow ${shortName(model_version)}`, isDisputed(contact) ?
      shadowText(contact) : `the same, ${shadowText(contact)}`]);
  }
  return facts(['Skin', contact.layout], ['Lasted',
    seconds(contact.duration_ns)], ...more);
}
