// A learning curve: one line for each of the newest parts of a phase that
// learns, over its iterations.

import uPlot from 'uplot';

import { colorNamed, DASHES } from '../curves';
import { element } from '../dom';
import type { LearningPoint } from '../wire';
import { number } from '../words';

const MOST_PARTS = 5;
const HEIGHT = 220;

// What a point measures, the likeliest to be of interest first.
const MEASURES: [keyof LearningPoint, string][] = [
  ['validation_loss', 'loss of contacts that were left out, in nats'],
  ['loss', 'loss'],
  ['log_likelihood', 'log-likelihood, in nats'],
  ['accuracy', 'accuracy'],
];

export class LearningChart {
  readonly root = element('figure', { class: 'chart learning' });
  // The phase that is shown; at first the newest.
  readonly choice = element('select', { 'aria-label': 'Phase' });
  private points: LearningPoint[] = [];
  // What was chosen for lack of a choice.
  private shownFirst = '';
  private plot?: uPlot;
  private shape = '';
  private readonly observer = new ResizeObserver(() => this.resize());
  private readonly dark = matchMedia('(prefers-color-scheme: dark)');
  private readonly redraw = (): void => this.plot?.redraw();

  constructor() {
    this.observer.observe(this.root);
    this.dark.addEventListener('change', this.redraw);
    this.choice.addEventListener('change', () => this.show(this.points));
  }

  // All points so far.
  show(points: LearningPoint[]): void {
    this.points = points;
    this.choosePhase();
    const last = points.filter(({ phase }) => phase === this.choice.value)
      .pop();
    if (last === undefined) return;
    const measure = MEASURES.find(([name]) => last[name] !== undefined &&
      last[name] !== null);
    if (measure === undefined) return;
    const [name, title] = measure;
    const own = points.filter((point) => point.phase === last.phase &&
      point[name] !== undefined && point[name] !== null);
    const parts = [...new Set(own.map((point) => point.part))]
      .slice(-MOST_PARTS);
    const steps = [...new Set(own.filter(({ part }) => parts.includes(part))
      .map((point) => point.iteration))].sort((a, b) => a - b);
    const lines = parts.map((part) => {
      const values = new Map(own.filter((point) => point.part === part)
        .map((point) => [point.iteration, Number(point[name])]));
      return steps.map((step) => values.get(step) ?? null);
    });
    this.draw(`${last.phase}: ${title}`, parts, [steps, ...lines]);
  }

  close(): void {
    this.observer.disconnect();
    this.dark.removeEventListener('change', this.redraw);
    this.plot?.destroy();
  }

  // A phase that comes later is shown, unless somebody looks at an older one.
  private choosePhase(): void {
    const phases = [...new Set(this.points.map(({ phase }) => phase))];
    const { options, value } = this.choice;
    if (options.length === phases.length) return;
    const chosen = value !== '' && value !== this.shownFirst ? value :
      this.newestCurve(phases);
    this.choice.replaceChildren(...phases.map((phase) =>
      element('option', {}, phase)));
    this.choice.value = chosen;
    if (chosen !== value) this.shownFirst = chosen;
  }

  // Of phases some have one point for each part, which is no curve.
  private newestCurve(phases: string[]): string {
    const counts = new Map<string, number>();
    const curves = new Set<string>();
    for (const { phase, part } of this.points) {
      const count = (counts.get(`${phase}\n${part}`) ?? 0) + 1;
      counts.set(`${phase}\n${part}`, count);
      if (count > 1) curves.add(phase);
    }
    return [...phases, ...curves].pop()!;
  }

  private draw(title: string, parts: string[],
      data: (number | null)[][]): void {
    const shape = [title, ...parts].join('\n');
    const all = data as uPlot.AlignedData;
    if (shape !== this.shape) {
      this.shape = shape;
      this.plot?.destroy();
      this.root.replaceChildren(element('figcaption', {},
        element('h3', {}, title), element('ul', { class: 'legend' },
          ...parts.map((part, i) => element('li', {},
            element('span', { 'aria-hidden': 'true',
              class: `swatch swatch-${i + 1}` }),
            element('span', { class: 'label' }, part))))));
      this.plot = new uPlot(optionsOf(parts), all, this.root);
      this.plot.ctx.canvas.setAttribute('role', 'img');
    } else {
      this.plot!.setData(all);
    }
    const now = data.slice(1).map((line, i) => `${parts[i]} ` +
      number(line.filter((value) => value !== null).pop() ?? NaN));
    this.plot!.ctx.canvas.setAttribute('aria-label',
      `${title}; now ${now.join(', ')}`);
    this.resize();
  }

  private resize(): void {
    const width = this.root.clientWidth;
    if (width > 0) this.plot?.setSize({ width, height: HEIGHT });
  }
}

function optionsOf(parts: string[]): uPlot.Options {
  const stroke = () => colorNamed('--ink-quiet');
  const grid = { stroke: () => colorNamed('--grid'), width: 1 };
  const axis = { stroke, grid, ticks: { show: false },
    font: '12px system-ui, sans-serif', gap: 4 };
  return {
    width: 400, height: HEIGHT, padding: [8, 16, 0, 0],
    legend: { show: false }, cursor: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...axis, size: 26, incrs: [1, 2, 5, 10, 20, 50, 100, 200] },
      { ...axis, size: 64, space: 32,
        values: (_, at) => at.map((value) => number(value)) }],
    series: [{}, ...parts.map((label, i) => ({
      label, stroke: () => colorNamed(`--curve-${i % DASHES.length + 1}`),
      dash: DASHES[i % DASHES.length]!, width: 1.75, spanGaps: true,
      // A part with one iteration has no line.
      points: { show: true, size: 5 },
    }))],
  };
}
