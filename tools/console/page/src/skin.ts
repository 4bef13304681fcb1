// Draws a skin: a colour for each taxel, and above it outlines of contacts,
// shear as arrows, hatches of taxels that are ignored, and the taxel that is
// picked.

import { colorOf } from './color_map';
import { element, setAttribute } from './dom';
import type { Contact } from './messages';
import { axesOf, geometryOf, loadOf, type Robot } from './robots';
import { isFelt, plural, quantity, unitOf, type FeltContact } from './words';

type Pen = CanvasRenderingContext2D;

const LIGHT = '#ffffff';
const DARK = '#0b0f16';
const PICKED = '#ff5ca8';
const PILL_HEIGHT = 18;
// A side of a taxel, in pixels, below which its arrow is not seen.
const LEAST_ARROW_CELL = 9;

export class SkinView {
  readonly root: HTMLElement;
  // Width by height.
  readonly aspect: number;
  private readonly colors: HTMLCanvasElement;
  private readonly lines: HTMLCanvasElement;
  private readonly image: ImageData;
  private readonly pixels: Uint32Array;
  private readonly observer: ResizeObserver;
  // Sides of a taxel in pixels of the page.
  private cellWidth = 0;
  private cellHeight = 0;
  private taxels = new Float32Array(0);
  private contacts: Contact[] = [];
  // What the lines show; drawing them is most of the work.
  private lined = '';
  picked?: number;

  constructor(private readonly robot: Robot) {
    const { rows, columns } = geometryOf(robot);
    this.colors = element('canvas', {
      width: String(columns), height: String(rows), 'aria-hidden': 'true' });
    this.lines = element('canvas', {
      role: 'img', 'aria-label': `skin of ${robot.name}` });
    this.aspect = aspectOf(robot);
    this.root = element('div', { class: 'skin' }, this.colors, this.lines);
    this.root.style.aspectRatio = String(this.aspect);
    this.root.style.setProperty('--aspect', String(this.aspect));
    this.image = new ImageData(columns, rows);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.root);
  }

  close(): void { this.observer.disconnect(); }

  // Shows a frame: of the robot now, or an earlier one.
  draw(taxels: Float32Array, contacts: Contact[]): void {
    this.taxels = taxels;
    this.contacts = contacts;
    for (let i = 0; i < this.pixels.length; ++i) {
      this.pixels[i] = colorOf(loadOf(this.robot, taxels, i), this.robot.full);
    }
    this.colors.getContext('2d')!.putImageData(this.image, 0, 0);
    this.drawLines();
  }

  // Says what is drawn to people who do not see it.
  describe(): void {
    const felt = this.contacts.filter(isFelt);
    const largest = Math.max(0, ...felt.map((c) => c.patch.force));
    const text = felt.length === 0 ? 'no contact' :
      `${plural(felt.length, 'contact')}, largest ` +
      quantity(largest, unitOf(geometryOf(this.robot)));
    setAttribute(this.lines, 'aria-label',
      `skin of ${this.robot.name}: ${text}`);
  }

  // The taxel under a pointer.
  taxelAt(event: PointerEvent): number | undefined {
    const box = this.lines.getBoundingClientRect();
    const { rows, columns } = geometryOf(this.robot);
    const column = Math.floor((event.clientX - box.left) / box.width * columns);
    const row = Math.floor((event.clientY - box.top) / box.height * rows);
    const inside = row >= 0 && row < rows && column >= 0 && column < columns;
    return inside ? row * columns + column : undefined;
  }

  // Gives the lines the pixels of the screen, so that they are sharp.
  private resize(): void {
    const { clientWidth, clientHeight } = this.root;
    const { rows, columns } = geometryOf(this.robot);
    this.cellWidth = clientWidth / columns;
    this.cellHeight = clientHeight / rows;
    this.lines.width = Math.round(clientWidth * devicePixelRatio);
    this.lines.height = Math.round(clientHeight * devicePixelRatio);
    this.lined = 'nothing';
    this.drawLines();
  }

  private drawLines(): void {
    const felt = this.contacts.filter(isFelt);
    const { masked_taxels, auxiliary_taxels } = geometryOf(this.robot);
    const masked = [...masked_taxels, ...auxiliary_taxels];
    const hasShear = axesOf(this.robot) === 3;
    const lined = `${this.picked}` + felt.map(({ id, patch }) =>
      ` ${id}: ${patch.taxels.join()}`).join();
    if (lined === this.lined && !hasShear) return;
    this.lined = lined;
    const pen = this.lines.getContext('2d')!;
    pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    pen.clearRect(0, 0, this.lines.width, this.lines.height);
    for (const taxel of masked) this.drawMasked(pen, taxel);
    if (hasShear) this.drawShear(pen);
    for (const contact of felt) this.drawOutline(pen, contact);
    for (const contact of felt) this.drawNumber(pen, contact);
    this.drawPicked(pen);
  }

  private place(taxel: number): [number, number] {
    const { columns } = geometryOf(this.robot);
    return [(taxel % columns) * this.cellWidth,
      Math.floor(taxel / columns) * this.cellHeight];
  }

  private drawMasked(pen: Pen, taxel: number): void {
    const [x, y] = this.place(taxel);
    pen.save();
    pen.beginPath();
    pen.rect(x, y, this.cellWidth, this.cellHeight);
    pen.clip();
    pen.fillStyle = DARK;
    pen.fillRect(x, y, this.cellWidth, this.cellHeight);
    pen.strokeStyle = LIGHT;
    pen.lineWidth = 1;
    pen.beginPath();
    for (let d = 0; d < this.cellWidth + this.cellHeight; d += 4) {
      line(pen, x + d, y, x + d - this.cellHeight, y + this.cellHeight);
    }
    pen.stroke();
    pen.restore();
  }

  // x points towards higher rows, y towards higher columns.
  private drawShear(pen: Pen): void {
    const cell = Math.min(this.cellWidth, this.cellHeight);
    const { full } = this.robot;
    if (cell < LEAST_ARROW_CELL || full === 0) return;
    pen.beginPath();
    for (let i = 0; i < this.pixels.length; ++i) {
      const right = (this.taxels[3 * i + 1] ?? 0) / full;
      const down = (this.taxels[3 * i] ?? 0) / full;
      const size = Math.hypot(right, down);
      if (size < 0.04) continue;
      // By the square root, as the colours.
      const length = Math.min(1, Math.sqrt(size)) * cell * 0.9 / size;
      const [x, y] = this.place(i);
      arrow(pen, x + this.cellWidth / 2, y + this.cellHeight / 2,
        right * length, down * length);
    }
    outline(pen, 1.2);
  }

  // The border of the touched taxels.
  private drawOutline(pen: Pen, contact: FeltContact): void {
    const { columns } = geometryOf(this.robot);
    const touched = new Set(contact.patch.taxels);
    const w = this.cellWidth;
    const h = this.cellHeight;
    pen.beginPath();
    for (const taxel of touched) {
      const [x, y] = this.place(taxel);
      const column = taxel % columns;
      if (!touched.has(taxel - columns)) line(pen, x, y, x + w, y);
      if (!touched.has(taxel + columns)) line(pen, x, y + h, x + w, y + h);
      if (column === 0 || !touched.has(taxel - 1)) line(pen, x, y, x, y + h);
      if (column === columns - 1 || !touched.has(taxel + 1)) {
        line(pen, x + w, y, x + w, y + h);
      }
    }
    outline(pen, 1.8);
  }

  // The contact's number, beside its region: its colours stay in sight.
  private drawNumber(pen: Pen, contact: FeltContact): void {
    const { rows, columns } = geometryOf(this.robot);
    const { taxels, centroid_row: row, centroid_column: column } =
      contact.patch;
    const pill = pillOf(contact.id);
    const width = pill.width / devicePixelRatio;
    const right = Math.max(column, ...taxels.map((t) => t % columns));
    const left = Math.min(column, ...taxels.map((t) => t % columns));
    const all = columns * this.cellWidth;
    const after = (right + 1) * this.cellWidth + 4;
    const x = after + width < all ? after :
      Math.max(2, left * this.cellWidth - width - 4);
    const middle = (row + 0.5) * this.cellHeight - PILL_HEIGHT / 2;
    const last = rows * this.cellHeight - PILL_HEIGHT - 2;
    const y = Math.max(2, Math.min(middle, last));
    pen.drawImage(pill, x, y, width, PILL_HEIGHT);
  }

  private drawPicked(pen: Pen): void {
    if (this.picked === undefined) return;
    const [x, y] = this.place(this.picked);
    pen.beginPath();
    pen.rect(x, y, this.cellWidth, this.cellHeight);
    pen.lineWidth = 5;
    pen.strokeStyle = DARK;
    pen.stroke();
    pen.lineWidth = 3;
    pen.strokeStyle = PICKED;
    pen.stroke();
  }
}

// Width by height of the skin, unrolled.
function aspectOf(robot: Robot): number {
  const geometry = geometryOf(robot);
  const { rows, columns } = geometry;
  const known = geometry.row_pitch_m > 0 && geometry.column_pitch_m > 0;
  const aspect = columns / rows *
    (known ? geometry.column_pitch_m / geometry.row_pitch_m : 1);
  // A single row stays wide enough to be seen.
  return Math.min(Math.max(aspect, 0.2), 8);
}

function line(pen: Pen, x0: number, y0: number, x1: number, y1: number): void {
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
}

function arrow(pen: Pen, x: number, y: number, dx: number, dy: number): void {
  const tip = [x + dx / 2, y + dy / 2] as const;
  line(pen, x - dx / 2, y - dy / 2, ...tip);
  pen.lineTo(tip[0] - 0.3 * dx + 0.2 * dy, tip[1] - 0.3 * dy - 0.2 * dx);
  line(pen, ...tip, tip[0] - 0.3 * dx - 0.2 * dy, tip[1] - 0.3 * dy + 0.2 * dx);
}

// Numbers on round grounds. They are kept, because drawing text is slow.
const pills = new Map<string, HTMLCanvasElement>();
const MOST_PILLS = 200;

function pillOf(text: string): HTMLCanvasElement {
  const key = `${text} ${devicePixelRatio}`;
  let pill = pills.get(key);
  if (pill === undefined) {
    if (pills.size >= MOST_PILLS) pills.clear();
    pill = makePill(text);
    pills.set(key, pill);
  }
  return pill;
}

function makePill(text: string): HTMLCanvasElement {
  const font = '600 12px system-ui, sans-serif';
  const canvas = element('canvas');
  const pen = canvas.getContext('2d')!;
  pen.font = font;
  const width = Math.max(pen.measureText(text).width + 10, PILL_HEIGHT);
  canvas.width = Math.ceil(width * devicePixelRatio);
  canvas.height = PILL_HEIGHT * devicePixelRatio;
  pen.scale(devicePixelRatio, devicePixelRatio);
  pen.roundRect(0, 0, width, PILL_HEIGHT, PILL_HEIGHT / 2);
  pen.fillStyle = LIGHT;
  pen.fill();
  pen.font = font;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.fillStyle = DARK;
  pen.fillText(text, width / 2, PILL_HEIGHT / 2 + 0.5);
  return canvas;
}

// Strokes the path: a light line within a dark one is seen on every colour.
function outline(pen: Pen, width: number): void {
  pen.lineCap = 'round';
  pen.strokeStyle = DARK;
  pen.lineWidth = 2.4 * width;
  pen.stroke();
  pen.strokeStyle = LIGHT;
  pen.lineWidth = width;
  pen.stroke();
}
