// Tables, and lists of facts.

import { element } from '../dom';

export type Cell = Node | string;

export interface Column {
  title: string;
  // Of numbers, which stand on the right.
  number?: boolean;
  // Left out if no row has anything in it.
  optional?: boolean;
}

// `caption` is for people who listen. The table scrolls within itself.
export function table(caption: string, columns: (Column | string)[],
    allRows: Cell[][]): HTMLElement {
  const all = columns.map((column): Column =>
    typeof column === 'string' ? { title: column } : column);
  const isKept = all.map(({ optional }, i) =>
    !optional || allRows.some((row) => row[i] !== ''));
  const kinds = all.filter((_, i) => isKept[i]);
  const rows = allRows.map((row) => row.filter((_, i) => isKept[i]));
  const classOf = (i: number): Record<string, string> =>
    kinds[i]?.number ? { class: 'number' } : {};
  const head = element('tr', {}, ...kinds.map(({ title }, i) =>
    title === '' ? element('td') :
      element('th', { scope: 'col', ...classOf(i) }, title)));
  const body = rows.map((row) => element('tr', {}, ...row.map((cell, i) =>
    element('td', isMoment(cell) ? { class: 'moment' } : classOf(i), cell))));
  return element('div', { class: 'table-box', tabindex: '0', role: 'region',
    'aria-label': caption },
  element('table', {},
    element('caption', { class: 'unseen' }, caption),
    element('thead', {}, head), element('tbody', {}, ...body)));
}

// Such a cell stays on one line.
function isMoment(cell: Cell): boolean {
  return typeof cell === 'string' && /^\d{4}-\d\d-\d\d /.test(cell);
}

export function facts(...pairs: [string, Cell][]): HTMLElement {
  return element('dl', { class: 'pairs' }, ...pairs.flatMap(([name, value]) =>
    [element('dt', {}, name), element('dd', {}, value)]));
}

export function link(href: string, text: string): HTMLAnchorElement {
  return element('a', { href, class: 'link' }, text);
}

export function button(text: string, onClick: () => void,
    kind = ''): HTMLButtonElement {
  const made = element('button', { type: 'button',
    ...(kind ? { class: kind } : {}) }, text);
  made.addEventListener('click', onClick);
  return made;
}

export function buttons(...all: Node[]): HTMLElement {
  return element('div', { class: 'buttons' }, ...all);
}

// A bar for each count, the largest of which is full.
export function bars(counts: [string, number][]): HTMLElement {
  const most = Math.max(1, ...counts.map(([, count]) => count));
  return element('ul', { class: 'bars' }, ...counts.map(([name, count]) => {
    const fill = element('span', { class: 'fill' });
    fill.style.transform = `scaleX(${count / most})`;
    return element('li', {},
      element('span', { class: 'value' }, name || '(no label)'),
      element('span', { class: 'percent' }, String(count)),
      element('span', { class: 'track', 'aria-hidden': 'true' }, fill));
  }));
}

// The head of a page or of a thing on it.
export function pageHead(title: string, back?: HTMLAnchorElement,
    ...more: Node[]): HTMLElement {
  if (back) back.className = 'back';
  return element('header', { class: 'full-head' }, ...(back ? [back] : []),
    element('h1', {}, title), ...more);
}
