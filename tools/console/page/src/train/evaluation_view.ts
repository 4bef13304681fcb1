// What an evaluation measured, and two versions on the same contacts.

import { element } from '../dom';
import { facts, table, type Cell } from '../parts/table';
import { share } from '../parts/texts';
import type { Accuracy, Comparison, Evaluation } from '../wire';

// Text stays dark on what is at most this dense.
const DENSEST = 0.4;

export function accuracyText(accuracy?: Accuracy | null): string {
  if (!accuracy || accuracy.contacts === 0) return 'no contact';
  const { correct, contacts, low, high } = accuracy;
  return `${share(correct, contacts)} (${correct} of ${contacts}; 95 % ` +
    `interval ${(100 * low).toFixed(1)} to ${(100 * high).toFixed(1)} %)`;
}

export function evaluationView(report: Evaluation): HTMLElement {
  const rows: [string, Cell][] = [['Accuracy', accuracyText(report.accuracy)],
    ['Log-loss', Number(report.log_loss).toFixed(4)],
    ['Calibration error', Number(report.calibration_error).toFixed(4)],
    ['Never felt', `${report.never_felt} trials`]];
  const warning = report.trained_on_data ? [element('p', { class: 'warn' },
    'No test: the model was trained on ' +
    `${report.trained_on_contacts} of these contacts.`)] : [];
  return element('section', { class: 'card part' },
    element('h2', {}, 'Evaluation'), ...warning,
    element('div', { class: 'evaluation' }, facts(...rows),
      confusionTable(report)),
    ...accuracyOverTime(report), ...wrongAnswers(report));
}

// Rows are true classes. Each cell has the share of its row, and the count.
export function confusionTable(report: Evaluation): HTMLElement {
  const names = report.class_names;
  const size = names.length;
  const questions = names.map((name, row) => {
    const counts = report.confusion.slice(row * size, (row + 1) * size);
    const whole = counts.reduce((sum, count) => sum + count, 0);
    return element('tr', {}, element('th', { scope: 'row' }, name),
      ...counts.map((count, column) => cellOf(count, whole, row === column)),
      element('td', { class: 'number quiet' }, String(whole)));
  });
  return element('div', { class: 'table-box', tabindex: '0', role: 'region',
    'aria-label': 'Confusion matrix' },
  element('table', { class: 'confusion' },
    element('caption', {}, 'Rows: true classes; columns: answers; share of ' +
      'the row, and contacts'),
    element('thead', {}, element('tr', {},
      element('td', {}), ...names.map((name) =>
        element('th', { scope: 'col' }, name)),
      element('th', { scope: 'col' }, 'all'))),
    element('tbody', {}, ...questions)));
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

function accuracyOverTime({ anytime, anytime_s }: Evaluation): Node[] {
  if (anytime.length === 0) return [];
  return [element('details', {},
    element('summary', {}, 'Accuracy over the time since onset'),
    table('Accuracy over time', [{ title: 'Seconds', number: true },
      'Accuracy'], anytime.map((accuracy, i) =>
      [String(anytime_s[i]), accuracyText(accuracy)])))];
}

function wrongAnswers({ wrong }: Evaluation): Node[] {
  if (wrong.length === 0) return [];
  return [element('details', {},
    element('summary', {}, `The first ${wrong.length} wrong answers`),
    table('Wrong answers', ['Recording', 'Label', 'Answer'],
      wrong.map(({ name, label, answer }) => [name, label, answer])))];
}

export function comparisonView(comparison: Comparison): HTMLElement {
  const { current, candidate } = comparison;
  const row = (name: string, of: (report?: Evaluation | null) => string) =>
    [name, of(current), of(candidate)];
  return element('section', { class: 'card part' },
    element('h2', {}, comparison.passed ? 'The gate was passed' :
      'The gate was not passed'),
    ...(comparison.failure ?
      [element('p', { class: 'warn' }, comparison.failure)] : []),
    table('Two versions on the same contacts', ['', 'Now', 'Candidate'], [
      row('Accuracy', (report) => accuracyText(report?.accuracy)),
      row('Log-loss', (report) => Number(report?.log_loss).toFixed(4)),
      row('Calibration error',
        (report) => Number(report?.calibration_error).toFixed(4)),
    ]),
    facts(['Only the present one right', String(comparison.only_current)],
      ['Only the candidate right', String(comparison.only_candidate)],
      ["McNemar's p", Number(comparison.mcnemar_p).toPrecision(3)]));
}
