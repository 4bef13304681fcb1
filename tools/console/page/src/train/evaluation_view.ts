// What evaluations measured: one alone, or two beside each other.

import { element } from '../dom';
import { facts, table, type Cell } from '../parts/table';
import { share } from '../parts/texts';
import type { Accuracy, Comparison, Evaluation } from '../wire';
import { confusionTable } from './confusion_table';
import { anytimeDrawing, dotsDrawing, reliabilityDrawing, type Dot,
  type Line } from './evaluation_charts';

// What an answer to all questions together is called: one of the classes. A
// single question is that, too.
const WHOLE = 'all classes';

export interface NamedEvaluation {
  // Of the model; empty if there is nothing to tell it from.
  name: string;
  report: Evaluation;
}

export function accuracyText(accuracy?: Accuracy | null): string {
  if (!accuracy || accuracy.contacts === 0) return 'no contact';
  const { correct, contacts } = accuracy;
  return `${share(correct, contacts)} (${correct} of ${contacts}; 95 % ` +
    `interval ${intervalText(accuracy)})`;
}

function intervalText({ low, high }: Accuracy): string {
  return `${(100 * low).toFixed(1)} to ${(100 * high).toFixed(1)} %`;
}

// Nothing is taken for granted of a report: contacts may be missing, and what
// earlier releases did not measure.
const isMeasured = ({ report }: NamedEvaluation): boolean =>
  (report.accuracy?.contacts ?? 0) > 0;
const isEarlier = ({ report }: NamedEvaluation): boolean =>
  report.reliability.length === 0;

export function evaluationView(all: NamedEvaluation[], ...tools: Node[]):
    HTMLElement {
  return element('section', { class: 'card part' },
    element('header', { class: 'part-head' },
      element('h2', {}, 'Evaluation'), ...tools),
    ...all.flatMap(warningsOf), ...figuresOf(all));
}

function warningsOf({ name, report }: NamedEvaluation): Node[] {
  if (!report.trained_on_data) return [];
  return [element('p', { class: 'warn' }, 'No test: ' +
    `${name || 'the model'} was trained on ${report.trained_on_contacts} ` +
    'of these contacts.')];
}

function figuresOf(all: NamedEvaluation[]): Node[] {
  const nodes: Node[] = [...summaryOf(all)];
  const measured = all.filter(isMeasured);
  const earlier = measured.filter(isEarlier);
  if (earlier.length > 0) {
    const which = earlier.map(({ name }) => name).filter((name) => name !== '')
      .join(' and ');
    nodes.push(element('p', { class: 'quiet' },
      `A server of an earlier release has evaluated${which && ` ${which}`}: ` +
      'it measured neither the questions nor the reliability. Evaluate ' +
      'again to see them.'));
  }
  if (measured.length > 0) {
    nodes.push(element('div', { class: 'drawings' }, ...drawingsOf(measured)));
  }
  return [...nodes, ...detailsOf(all)];
}

// The figures of one evaluation beside its confusions; of two in a table.
function summaryOf(all: NamedEvaluation[]): Node[] {
  const confusions = all.map(({ name, report }) =>
    confusionTable(name, report));
  const rows = rowsOf(all);
  const figures = all.length === 1 ?
    facts(...rows.map(([title, cell]): [string, Cell] => [title!, cell!])) :
    table('The evaluations beside each other',
      ['', ...all.map(({ name }) => name)], rows);
  if (all.length > 1) {
    return [figures, element('div', { class: 'evaluation' }, ...confusions)];
  }
  return [element('div', { class: 'evaluation' }, figures, ...confusions)];
}

function rowsOf(all: NamedEvaluation[]): string[][] {
  const row = (title: string, of: (report: Evaluation) => string) =>
    [title, ...all.map(({ report }) => of(report))];
  return [row('Accuracy', ({ accuracy }) => accuracyText(accuracy)),
    ...questionsOf(all).map((name) => row(`Accuracy of ${name}`, (report) => {
      const found = report.questions.find((own) => own.name === name);
      return found ? accuracyText(found.accuracy) : '–';
    })),
    row('Log-loss', ({ log_loss }) => Number(log_loss).toFixed(4)),
    row('Calibration error', ({ calibration_error }) =>
      Number(calibration_error).toFixed(4)),
    row('Never felt', ({ never_felt }) => `${never_felt} trials`)];
}

// In the order in which they come first.
function questionsOf(all: NamedEvaluation[]): string[] {
  return [...new Set(all.flatMap(({ report }) =>
    report.questions.map(({ name }) => name)))];
}

function drawingsOf(all: NamedEvaluation[]): Node[] {
  const nodes: Node[] = [];
  const names = all.map(({ name }) => name);
  const dots = dotsOf(all);
  if (questionsOf(all).length > 1) {
    nodes.push(dotsDrawing('Accuracy of each question', dots, names));
  }
  const times = all[0]!.report.anytime_s;
  const same = all.filter(({ report }) => report.anytime.length > 0 &&
    report.anytime_s.join() === times.join());
  if (same.length > 0) {
    nodes.push(anytimeDrawing('Accuracy over the time since onset', times,
      linesOf(same)));
  }
  return [...nodes, ...all.flatMap((evaluation, i) => isEarlier(evaluation) ?
    [] : [reliabilityDrawing('Reliability' + (evaluation.name &&
      ` of ${evaluation.name}`), evaluation.report, i)])];
}

// The dots of one question are beside each other.
function dotsOf(all: NamedEvaluation[]): Dot[] {
  const dot = (name: string, of: number, accuracy?: Accuracy | null): Dot[] =>
    accuracy && accuracy.contacts > 0 ? [{ name, of, accuracy }] : [];
  return [...all.flatMap(({ report }, i) => dot(WHOLE, i, report.accuracy)),
    ...questionsOf(all).flatMap((name) => all.flatMap(({ report }, i) =>
      dot(name, i, report.questions.find((own) => own.name === name)
        ?.accuracy)))];
}

// Of one evaluation, the classes and each question; of two, the classes alone.
function linesOf(all: NamedEvaluation[]): Line[] {
  const [first] = all;
  if (all.length > 1) {
    return all.map(({ name, report }) => ({ name, points: report.anytime }));
  }
  const { anytime, questions } = first!.report;
  return [{ name: WHOLE, points: anytime }, ...questions
    .filter((question) => questions.length > 1 &&
      question.anytime.length === anytime.length)
    .map((question) => ({ name: question.name, points: question.anytime }))];
}

// What the drawings show, in numbers.
function detailsOf(all: NamedEvaluation[]): Node[] {
  return all.flatMap(({ name, report }) => {
    const of = name && ` of ${name}`;
    const { anytime, anytime_s, questions, reliability, wrong } = report;
    const details = (title: string, ...nodes: Node[]) =>
      element('details', {}, element('summary', {}, title), ...nodes);
    const number = (title: string) => ({ title, number: true });
    return [
      ...(anytime.length === 0 ? [] : [details(
        `Accuracy over the time since onset${of}`,
        table('Accuracy over time', [number('Seconds'), 'Accuracy',
          ...questions.map((question) => question.name)],
        anytime.map((accuracy, i) => [String(anytime_s[i]),
          accuracyText(accuracy), ...questions.map((question) =>
            accuracyText(question.anytime[i]))])))]),
      ...(reliability.length === 0 ? [] : [details(`Reliability${of}`,
        table('Reliability', ['Probability of the answer', number('Mean'),
          number('Contacts'), number('Right'), '95 % interval'],
        reliability.map(({ low, high, confidence, accuracy }) => [
          `${low.toFixed(3)} to ${high.toFixed(3)}`, confidence.toFixed(3),
          String(accuracy.contacts), share(accuracy.correct,
            accuracy.contacts), intervalText(accuracy)])))]),
      ...(wrong.length === 0 ? [] : [details(
        `Wrong answers${of} (${wrong.length} of them)`,
        table('Wrong answers', ['Recording', 'Label', 'Answer'],
          wrong.map((answer) => [answer.name, answer.label,
            answer.answer])))])];
  });
}

export function comparisonView(comparison: Comparison): HTMLElement {
  const { current, candidate } = comparison;
  const all = [{ name: 'Now', report: current },
    { name: 'Candidate', report: candidate }].filter(
    (named): named is NamedEvaluation => Boolean(named.report));
  return element('section', { class: 'card part' },
    element('h2', {}, comparison.passed ? 'The gate was passed' :
      'The gate was not passed'),
    ...(comparison.failure ?
      [element('p', { class: 'warn' }, comparison.failure)] : []),
    facts(['Only the present one right', String(comparison.only_current)],
      ['Only the candidate right', String(comparison.only_candidate)],
      ["McNemar's p", Number(comparison.mcnemar_p).toPrecision(3)]),
    ...all.flatMap(warningsOf), ...figuresOf(all));
}
