// Curves over time, by uPlot: one chart for loads, one for each question. Each
// has a legend with the values of the moment that is shown.

import uPlot from 'uplot';

import { element, setAttribute, setText } from './dom';
import type { Series } from './history';

// Curves differ by dashes, too. The names are those of app.css.
export const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3], [4, 4]];
const COLORS = DASHES.map((_, i) => `--curve-${i + 1}`);
const HEIGHT = 112;
// Frames that are farther apart are not joined by a line.
const GAP_S = 0.8;
// Signs of events that are nearer to each other would overlap.
const SIGN_WIDTH = 13;

export interface Mark {
  time: number;
  sign: string;
}

export interface Window {
  from: number;
  to: number;
  marks: Mark[];
  // The moment that is shown, if it is not the newest.
  cursor?: number;
}

export interface ChartOptions {
  title: string;
  names: string[];
  // Of all values; none to fit them.
  range?: [number, number];
  // A value in words.
  text: (value: number) => string;
  // Called with a time when somebody clicks or drags on the chart.
  onTime: (time: number) => void;
}

export class Chart {
  readonly root: HTMLElement;
  private readonly plot: uPlot;
  private readonly values: HTMLElement[] = [];
  private window: Window = { from: 0, to: 1, marks: [] };

  constructor(private readonly options: ChartOptions) {
    const legend = element('ul', { class: 'legend' }, ...options.names.map(
      (name, i) => this.makeLegend(name, i)));
    this.root = element('figure', { class: 'chart' },
      element('figcaption', {}, element('h3', {}, options.title), legend));
    const stroke = () => colorNamed('--ink-quiet');
    const grid = { stroke: () => colorNamed('--grid'), width: 1 };
    const ticks = { show: false };
    const font = '12px system-ui, sans-serif';
    this.plot = new uPlot({
      width: 400, height: HEIGHT, padding: [16, 20, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, y: false,
        points: { show: false } },
      scales: {
        x: { time: false,
          range: () => [this.window.from, this.window.to] },
        y: { range: (_, least, most) => rangeOf(options, least, most) },
      },
      axes: [
        { stroke, grid, ticks, font, size: 24, gap: 4, space: 64,
          values: (_, at) => at.map(timeText) },
        { stroke, grid, ticks, font, size: 42, gap: 4, space: 26,
          ...(options.range ? { splits: () => [0, 0.5, 1],
            values: () => ['0 %', '50 %', '100 %'] } : {}) },
      ],
      series: [{}, ...options.names.map((label, i) => ({
        label, stroke: () => colorNamed(COLORS[i % COLORS.length]!),
        dash: DASHES[i % DASHES.length]!, width: 1.75,
        points: { show: false }, gaps: gapsOf,
      }))],
      hooks: { draw: [() => this.drawMarks()] },
    }, [[], ...options.names.map(() => [])], this.root);
    this.plot.ctx.canvas.setAttribute('role', 'img');
    this.listen();
  }

  // `now`: the values at the moment that is shown.
  set(window: Window, times: number[], series: Series[],
      now: (number | null)[]): void {
    this.window = window;
    const texts = now.map((value) =>
      value === null ? '–' : this.options.text(value));
    texts.forEach((text, i) => setText(this.values[i]!, text));
    setAttribute(this.plot.ctx.canvas, 'aria-label',
      `${this.options.title} over time; at the moment shown: ` +
      this.options.names.map((name, i) => `${name} ${texts[i]}`).join(', '));
    this.plot.setData([times, ...series]);
  }

  resize(width: number): void {
    if (width > 0) this.plot.setSize({ width, height: HEIGHT });
  }

  redraw(): void { this.plot.redraw(); }

  close(): void { this.plot.destroy(); }

  private makeLegend(name: string, i: number): HTMLElement {
    const swatch = element('span', { 'aria-hidden': 'true',
      class: `swatch swatch-${i % DASHES.length + 1}` });
    const value = element('span', { class: 'now' });
    this.values.push(value);
    return element('li', {}, swatch,
      element('span', { class: 'label' }, name), value);
  }

  private listen(): void {
    const { over } = this.plot;
    const at = (event: PointerEvent) => {
      const x = event.clientX - over.getBoundingClientRect().left;
      this.options.onTime(this.plot.posToVal(x, 'x'));
    };
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      at(event);
    });
    over.addEventListener('pointermove', (event) => {
      if (event.buttons === 1) at(event);
    });
  }

  private drawMarks(): void {
    const pen = this.plot.ctx;
    const { left, top, width, height } = this.plot.bbox;
    const ratio = devicePixelRatio;
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, width, top + height);
    pen.clip();
    pen.font = `${12 * ratio}px system-ui, sans-serif`;
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.fillStyle = colorNamed('--ink-quiet');
    const color = colorNamed('--mark');
    let free = -Infinity;
    for (const { time, sign } of this.window.marks) {
      const x = this.plot.valToPos(time, 'x', true);
      this.drawLine(x, color, [3 * ratio, 3 * ratio], ratio);
      if (x < free) continue;
      free = x + SIGN_WIDTH * ratio;
      pen.fillText(sign, x, top - 8 * ratio);
    }
    if (this.window.cursor !== undefined) {
      const x = this.plot.valToPos(this.window.cursor, 'x', true);
      this.drawLine(x, colorNamed('--cursor'), [], 2 * ratio);
    }
    pen.restore();
  }

  private drawLine(at: number, color: string, dash: number[], width: number):
      void {
    const pen = this.plot.ctx;
    const { top, height } = this.plot.bbox;
    const x = Math.round(at);
    pen.setLineDash(dash);
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(x, top);
    pen.lineTo(x, top + height);
    pen.stroke();
  }
}

// A colour of app.css; light and dark have their own.
export function colorNamed(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name);
}

function timeText(time: number): string {
  if (time < 0) return `-${timeText(-time)}`;
  const minutes = Math.floor(time / 60);
  const rest = time - 60 * minutes;
  const text = Number.isInteger(rest) ? String(rest).padStart(2, '0') :
    rest.toFixed(1).padStart(4, '0');
  return `${minutes}:${text}`;
}

function rangeOf(options: ChartOptions, least: number | null,
    most: number | null): [number, number] {
  if (options.range) {
    // Lines at both ends are seen in full.
    return [options.range[0] - 0.04, options.range[1] + 0.04];
  }
  const top = (most ?? 0) > 0 ? most! * 1.08 : 1;
  return [Math.min(0, least ?? 0), top];
}

// Where no frames came, in pixels.
function gapsOf(plot: uPlot, _: number, from: number, to: number,
    gaps: uPlot.Series.Gaps): uPlot.Series.Gaps {
  const times = plot.data[0];
  for (let i = from; i < to; ++i) {
    if (times[i + 1]! - times[i]! < GAP_S) continue;
    gaps.push([Math.round(plot.valToPos(times[i]!, 'x', true)),
      Math.round(plot.valToPos(times[i + 1]!, 'x', true))]);
  }
  return gaps.sort((a, b) => a[0] - b[0]);
}
