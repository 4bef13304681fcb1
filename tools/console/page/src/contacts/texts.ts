// What is said about a contact.

import { element, type Child } from '../dom';
import { shortName } from '../parts/texts';
import { percent } from '../words';
import type { Draft } from './drafts';
import type { Logged, LoggedAnswer } from './messages';

// "contacts/17-2" as "17-2".
export function numberOf({ name }: { name: string }): string {
  return shortName(name);
}

// By the clock of this machine; the day only if it is another one.
export function timeText(ms: string): string {
  const date = new Date(Number(ms));
  const two = (value: number) => String(value).padStart(2, '0');
  const time = `${two(date.getHours())}:${two(date.getMinutes())}:` +
    two(date.getSeconds());
  if (date.toDateString() === new Date().toDateString()) return time;
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-` +
    `${two(date.getDate())} ${time}`;
}

export function isStrange({ unknown }: Logged): boolean {
  return unknown > 0.5;
}

export function isDisputed({ shadow, label }: Logged): boolean {
  return !!shadow && shadow.label !== label;
}

export function robotOf({ robot, caller }: Logged): string {
  return robot || caller || 'a robot without a name';
}

export function tag(text: string, kind = ''): HTMLElement {
  return element('span', { class: kind ? `tag ${kind}` : 'tag' }, text);
}

// The most probable class, and how sure that is.
export function answeredCell(contact: Logged): HTMLElement {
  const fill = element('span', { class: 'fill' });
  fill.style.transform =
    `scaleX(${Math.min(Math.max(contact.confidence, 0), 1)})`;
  return element('div', { class: 'answered' },
    element('span', { class: 'value' }, contact.label),
    element('span', { class: 'percent' }, percent(contact.confidence)),
    element('span', { class: 'track', 'aria-hidden': 'true' }, fill),
    ...(isStrange(contact) ?
      [tag(`? unknown ${percent(contact.unknown)}`, 'warned')] : []));
}

export function answerLine(answer: LoggedAnswer, named = true): HTMLElement {
  const parts: Child[] = [element('b', {},
    `${answer.value} ${percent(answer.probability)}`)];
  if (named) {
    parts.unshift(element('span', { class: 'quiet' }, `${answer.question} `));
  }
  if (!answer.decided) parts.push(' ', tag('undecided', 'open'));
  if (answer.revised) parts.push(' ', tag('revised', 'warned'));
  return element('span', { class: 'answer-line' }, ...parts);
}

export function shadowText({ shadow }: Logged): string {
  if (!shadow) return '';
  return shadow.label === '' ? 'felt no such contact' :
    `${shadow.label} ${percent(shadow.confidence)}`;
}

// The label that will be, and the one that is.
export function labelCell({ given }: Logged, draft?: Draft): HTMLElement {
  const cell = element('div', { class: 'label-cell' });
  if (draft) {
    cell.append(element('span', { class: 'draft' }, draft.label),
      element('small', {}, draft.prefilled ? 'confirmed, not saved' :
        'not saved'));
  }
  if (!given) return cell;
  const by = given.labelling?.by ? ` by ${given.labelling.by}` : '';
  if (draft) {
    cell.append(element('small', {}, `before: ${given.label}${by}`));
  } else {
    cell.append(element('span', { class: 'given' }, given.label),
      element('small', {}, `${shortName(given.dataset_version)}${by}`));
  }
  return cell;
}
