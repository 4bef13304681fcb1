// Curves over time, by uPlot: one chart for loads, one for each question.

import uPlot from 'uplot';

import { element } from './dom';

// Colours and dashes that differ without colour, too.
const STROKES = ['#3b7dd8', '#d98200', '#1d9a6c', '#c2439b', '#7a7a7a'];
const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3], [4, 4]];
const HEIGHT = 150;

export interface Mark {
  time: number;
  text: string;
}

export class Curves {
  readonly root: HTMLElement;
  private readonly plot: uPlot;
  private marks: Mark[] = [];
  private cursor?: number;

  // `range`: of the values, or none to fit them. `pick` is called with a time
  // when a user clicks or drags on the chart.
  constructor(title: string, names: string[], unit: string,
      range: [number, number] | undefined, pick: (time: number) => void) {
    this.root = element('figure', { class: 'curves' },
      element('figcaption', {}, unit ? `${title} (${unit})` : title));
    const ink = getComputedStyle(document.body).color;
    const grid = { stroke: 'rgba(128, 128, 128, 0.25)', width: 1 };
    this.plot = new uPlot({
      width: 600, height: HEIGHT,
      legend: { show: true, live: false },
      cursor: { drag: { x: false, y: false }, y: false },
      scales: { x: { time: false }, ...(range ? { y: { range } } : {}) },
      axes: [
        { stroke: ink, grid, size: 32, values: (_, at) => at.map((t) => `${t} s`) },
        { stroke: ink, grid, size: 52 },
      ],
      series: [{}, ...names.map((label, i) => ({
        label, stroke: STROKES[i % STROKES.length]!,
        dash: DASHES[i % DASHES.length]!, width: 2,
        points: { show: false },
      }))],
      hooks: { draw: [() => this.drawMarks()] },
    }, [[], ...names.map(() => [])], this.root);
    this.listen(pick);
  }

  set(times: number[], series: (number | null)[][], marks: Mark[],
      cursor: number | undefined): void {
    this.marks = marks;
    this.cursor = cursor;
    this.plot.setData([times, ...series]);
  }

  resize(width: number): void {
    if (width > 0) this.plot.setSize({ width, height: HEIGHT });
  }

  destroy(): void { this.plot.destroy(); }

  private listen(pick: (time: number) => void): void {
    const over = this.plot.over;
    const at = (event: PointerEvent) =>
      pick(this.plot.posToVal(event.offsetX, 'x'));
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
    pen.save();
    pen.beginPath();
    pen.rect(left, top, width, height);
    pen.clip();
    for (const mark of this.marks) {
      this.drawLine(pen, mark.time, 'rgba(128, 128, 128, 0.7)', [3, 3]);
    }
    if (this.cursor !== undefined) {
      this.drawLine(pen, this.cursor, '#ff4fa3', []);
    }
    pen.restore();
  }

  private drawLine(pen: CanvasRenderingContext2D, time: number, color: string,
      dash: number[]): void {
    const { top, height } = this.plot.bbox;
    const x = Math.round(this.plot.valToPos(time, 'x', true));
    pen.setLineDash(dash);
    pen.strokeStyle = color;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(x, top);
    pen.lineTo(x, top + height);
    pen.stroke();
  }
}
