// Drawings of what evaluations measured, each with 95 % intervals: accuracy of
// each question, accuracy over the time since onset, and how often answers are
// right by the probability that they had.

import { element } from '../dom';
import { pathOf, svg } from '../parts/svg';
import { share } from '../parts/texts';
import type { Accuracy, Evaluation } from '../wire';
import { percent, plural } from '../words';

export interface Line {
  name: string;
  // Accuracy at each of the times.
  points: Accuracy[];
}

export interface Dot {
  name: string;
  // Which of the compared evaluations, from 0.
  of: number;
  accuracy: Accuracy;
}

const WIDTH = 400;
const LEFT = 48;
const RIGHT = 12;
const TOP = 10;
// Of the drawing of questions.
const ROW = 20;
const GROUP_GAP = 8;
// Curves of app.css.
const MOST_LINES = 5;
// A bin of fewer contacts says little: its interval is wide.
const FEW_CONTACTS = 10;
const BINS = 15;

const fraction = ({ correct, contacts }: Accuracy): number =>
  contacts > 0 ? correct / contacts : 0;

// From 0, or from a mark below all that is shown.
function lowestOf(shown: Accuracy[]): number {
  const least = Math.min(1, ...shown.map(({ low }) => low));
  return least >= 0.75 ? 0.75 : least >= 0.5 ? 0.5 : 0;
}

function figure(title: string, names: string[], drawing: SVGSVGElement):
    HTMLElement {
  const legend = element('ul', { class: 'legend' }, ...names.map((name, i) =>
    element('li', {}, element('span', { 'aria-hidden': 'true',
      class: `swatch swatch-${i + 1}` }),
    element('span', { class: 'label' }, name))));
  return element('figure', { class: 'chart drawing' },
    element('figcaption', {}, element('h3', {}, title),
      ...(names.length > 1 ? [legend] : [])), drawing);
}

function drawingOf(height: number, label: string): SVGSVGElement {
  return svg('svg', { viewBox: `0 0 ${WIDTH} ${height}`, role: 'img',
    'aria-label': label });
}

const textAt = (x: number, y: number, text: string, kind = ''): SVGElement =>
  svg('text', { x: x.toFixed(1), y: y.toFixed(1), ...(kind ?
    { class: kind } : {}) }, text);

const line = (kind: string, x1: number, y1: number, x2: number, y2: number):
    SVGElement => svg('path', { class: kind, d: pathOf([[x1, y1], [x2, y2]]) });

// Marks of a scale of accuracies.
function marksFrom(low: number): number[] {
  const step = low === 0.75 ? 0.05 : low === 0.5 ? 0.1 : 0.25;
  return Array.from({ length: Math.round((1 - low) / step) + 1 },
    (_, i) => low + i * step);
}

function accuracyScale(low: number, y: (value: number) => number):
    SVGElement[] {
  return marksFrom(low).flatMap((at) => [
    line('rule', LEFT, y(at), WIDTH - RIGHT, y(at)),
    textAt(LEFT - 6, y(at) + 4, percent(at), 'end')]);
}

export function dotsDrawing(title: string, dots: Dot[], names: string[]):
    HTMLElement {
  const left = 140;
  const low = lowestOf(dots.map(({ accuracy }) => accuracy));
  const groups = [...new Set(dots.map(({ name }) => name))];
  const group = names.length * ROW + GROUP_GAP;
  const bottom = TOP + group * groups.length;
  const x = (value: number) =>
    left + (value - low) / (1 - low) * (WIDTH - RIGHT - 8 - left);
  const drawing = drawingOf(bottom + 24, `${title}: ` + dots.map((dot) =>
    `${dot.name} ${names[dot.of] ?? ''} ` +
      share(dot.accuracy.correct, dot.accuracy.contacts)).join(', '));
  for (const at of marksFrom(low)) {
    drawing.append(line('rule', x(at), TOP, x(at), bottom),
      textAt(x(at), bottom + 16, percent(at), 'middle'));
  }
  groups.forEach((name, i) => {
    const text = textAt(left - 10, TOP + group * (i + 0.5) + 4,
      shortened(name), 'end ink');
    text.append(svg('title', {}, name));
    drawing.append(text);
  });
  drawing.append(...dots.map(({ name, of, accuracy }) => {
    const y = TOP + group * groups.indexOf(name) + GROUP_GAP / 2 +
      ROW * (of + 0.5);
    return svg('g', { class: `curve-${of + 1}` },
      line('whisker', x(accuracy.low), y, x(accuracy.high), y),
      svg('circle', { cx: x(fraction(accuracy)).toFixed(1), cy: y, r: 4.5 }));
  }));
  return figure(title, names, drawing);
}

// What the margin has room for.
function shortened(name: string): string {
  return name.length > 18 ? `${name.slice(0, 17)}…` : name;
}

export function anytimeDrawing(title: string, times: number[], all: Line[]):
    HTMLElement {
  const lines = all.slice(0, MOST_LINES);
  const height = 250;
  const bottom = height - 36;
  const low = lowestOf(lines.flatMap(({ points }) => points));
  const y = (value: number) =>
    bottom - (value - low) / (1 - low) * (bottom - TOP);
  const first = Math.log(times[0]!);
  const span = Math.log(times[times.length - 1]!) - first || 1;
  const x = (time: number) =>
    LEFT + 10 + (Math.log(time) - first) / span * (WIDTH - RIGHT - LEFT - 20);
  const drawing = drawingOf(height, `${title}; in the end ` +
    lines.map(({ name, points }) => `${name} ` +
      percent(fraction(points[points.length - 1]!))).join(', '));
  drawing.append(...accuracyScale(low, y),
    ...times.map((time) => textAt(x(time), bottom + 16, String(time),
      'middle')),
    textAt(WIDTH - RIGHT, height - 4, 'seconds since onset', 'end'));
  // Bands of many lines would hide each other.
  if (lines.length < 4) {
    drawing.append(...lines.map(({ points }, i) => svg('path', {
      class: `band curve-${i + 1}`, d: pathOf([
        ...points.map(({ high }, t): [number, number] =>
          [x(times[t]!), y(high)]),
        ...points.map(({ low: least }, t): [number, number] =>
          [x(times[t]!), y(least)]).reverse()]) + 'Z' })));
  }
  drawing.append(...lines.map(({ points }, i) => {
    const places = points.map((point, t): [number, number] =>
      [x(times[t]!), y(fraction(point))]);
    return svg('g', { class: `curve-${i + 1}` },
      svg('path', { class: 'line', d: pathOf(places) }),
      ...places.map(([cx, cy]) =>
        svg('circle', { cx: cx.toFixed(1), cy: cy.toFixed(1), r: 3 })));
  }));
  return figure(title, lines.map(({ name }) => name), drawing);
}

// Answers over the probability that they had; the diagonal is what it promises.
// Below, how many contacts each bin has.
export function reliabilityDrawing(title: string,
    { reliability: bins }: Evaluation, curve: number): HTMLElement {
  const height = 320;
  const bottom = 214;
  const floor = 286;
  const low = Math.min(bins[0]!.low, (BINS - 1) / BINS);
  const x = (value: number) =>
    LEFT + (value - low) / (1 - low) * (WIDTH - RIGHT - LEFT);
  const y = (value: number) => bottom - value * (bottom - TOP);
  const most = Math.max(...bins.map(({ accuracy }) => accuracy.contacts));
  const drawing = drawingOf(height, `${title}: ` + bins.map((bin) =>
    `of ${plural(bin.accuracy.contacts, 'contact')} with a mean probability ` +
    `of ${percent(bin.confidence)}, ${percent(fraction(bin.accuracy))} are ` +
    'right').join('; '));
  drawing.append(...accuracyScale(0, y),
    line('diagonal', x(low), y(low), x(1), y(1)));
  const trusted = bins.filter(({ accuracy }) =>
    accuracy.contacts >= FEW_CONTACTS);
  drawing.append(svg('g', { class: `curve-${curve + 1}` },
    svg('path', { class: 'line', d: pathOf(trusted.map((bin) =>
      [x(bin.confidence), y(fraction(bin.accuracy))])) }),
    ...bins.flatMap(({ confidence, accuracy }) => [
      line('whisker', x(confidence), y(accuracy.low), x(confidence),
        y(accuracy.high)),
      svg('circle', { cx: x(confidence).toFixed(1),
        cy: y(fraction(accuracy)).toFixed(1), r: 4,
        ...(accuracy.contacts < FEW_CONTACTS ? { class: 'few' } : {}) })]),
    ...bins.map((bin) => {
      const rise = (floor - bottom - 22) * bin.accuracy.contacts / most;
      return svg('rect', { class: 'bin', x: (x(bin.low) + 1).toFixed(1),
        y: (floor - rise).toFixed(1), height: rise.toFixed(1),
        width: Math.max(1, x(bin.high) - x(bin.low) - 2).toFixed(1) });
    })),
  ...bins.map(({ low: from, high, accuracy }) => {
    const rise = (floor - bottom - 22) * accuracy.contacts / most;
    return textAt((x(from) + x(high)) / 2, floor - rise - 4,
      countText(accuracy.contacts), 'middle small');
  }),
  line('rule', LEFT, floor, WIDTH - RIGHT, floor),
  ...marksOf(low).map((at) =>
    textAt(x(at), floor + 15, percent(at), at === 1 ? 'end' : 'middle')),
  textAt(LEFT, height - 3, 'bars: contacts'),
  textAt(WIDTH - RIGHT, height - 3, 'probability of the answer', 'end'));
  return figure(title, [], drawing);
}

function marksOf(low: number): number[] {
  const step = low < 0.5 ? 0.2 : 0.1;
  return [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map((i) => i / 10)
    .filter((at) => at >= low - 1e-9 &&
      Math.abs(at / step - Math.round(at / step)) < 1e-6);
}

// A bin has room for four digits.
function countText(count: number): string {
  return count < 10_000 ? String(count) : `${Math.round(count / 1000)}k`;
}
