// Which classes were taken for which.

import { element } from '../dom';
import type { Evaluation } from '../wire';

// Text stays dark on what is at most this dense.
const DENSEST = 0.4;

// Rows are true classes. Each cell has the share of its row, and the count.
// `name`: of the model; may be empty.
export function confusionTable(name: string, report: Evaluation): HTMLElement {
  const names = report.class_names;
  const size = names.length;
  const rows = names.map((own, row) => {
    const counts = report.confusion.slice(row * size, (row + 1) * size);
    const whole = counts.reduce((sum, count) => sum + count, 0);
    return element('tr', {}, element('th', { scope: 'row' }, own),
      ...counts.map((count, column) => cellOf(count, whole, row === column)),
      element('td', { class: 'number quiet' }, String(whole)));
  });
  const title = `Confusion matrix${name && ` of ${name}`}`;
  return element('div', { class: 'table-box', tabindex: '0', role: 'region',
    'aria-label': title },
  element('table', { class: 'confusion' },
    element('caption', {}, `${name && `${name}. `}Rows: true classes; ` +
      'columns: answers; share of the row, and contacts'),
    element('thead', {}, element('tr', {},
      element('td', {}), ...names.map((own) =>
        element('th', { scope: 'col' }, own)),
      element('th', { scope: 'col' }, 'all'))),
    element('tbody', {}, ...rows)));
}

function cellOf(count: number, whole: number, right: boolean):
    HTMLTableCellElement {
  const cell = element('td', { class: right ? 'right' : 'wrong' });
  cell.style.setProperty('--density',
    `${whole > 0 ? Math.round(100 * DENSEST * count / whole) : 0}%`);
  cell.append(count === 0 ? '–' : `${Math.round(100 * count / whole)} %`);
  if (count > 0) cell.append(element('small', {}, String(count)));
  return cell;
}
