// Draws a skin: a colour for each taxel, and above it outlines of contacts,
// shear as arrows, and the taxel that is picked.

import { colorOf } from './color_map';
import { element } from './dom';
import type { Contact } from './messages';
import { geometryOf, loadOf, type Robot } from './robots';
import { isFelt, number, unitOf, type FeltContact } from './words';

// Canvas pixels of a taxel's side in the layer above the colours.
const CELL = 16;

export class SkinView {
  readonly root: HTMLElement;
  private readonly colors: HTMLCanvasElement;
  private readonly lines: HTMLCanvasElement;
  private readonly image: ImageData;
  private readonly pixels: Uint32Array;
  private readonly masked: Set<number>;
  picked?: number;

  constructor(private readonly robot: Robot) {
    const { rows, columns, masked_taxels: masked } = geometryOf(robot);
    this.masked = new Set(masked);
    this.colors = element('canvas', {
      width: String(columns), height: String(rows), 'aria-hidden': 'true' });
    this.lines = element('canvas', {
      width: String(columns * CELL), height: String(rows * CELL),
      role: 'img', 'aria-label': `skin of ${robot.name}` });
    this.root = element('div', { class: 'skin' }, this.colors, this.lines);
    this.root.style.aspectRatio = `${columns} / ${rows}`;
    this.image = new ImageData(columns, rows);
    this.pixels = new Uint32Array(this.image.data.buffer);
  }

  // Shows a frame: of the robot now, or an earlier one.
  draw(taxels: Float32Array, contacts: Contact[]): void {
    for (let i = 0; i < this.pixels.length; ++i) {
      this.pixels[i] = colorOf(loadOf(this.robot, taxels, i), this.robot.full);
    }
    this.colors.getContext('2d')!.putImageData(this.image, 0, 0);
    const pen = this.lines.getContext('2d')!;
    pen.clearRect(0, 0, this.lines.width, this.lines.height);
    this.drawMasked(pen);
    this.drawShear(pen, taxels);
    const felt = contacts.filter(isFelt);
    for (const contact of felt) this.drawContact(pen, contact);
    this.drawPicked(pen);
    this.describe(felt);
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

  private place(taxel: number): [number, number] {
    const { columns } = geometryOf(this.robot);
    return [(taxel % columns) * CELL, Math.floor(taxel / columns) * CELL];
  }

  private drawMasked(pen: CanvasRenderingContext2D): void {
    pen.strokeStyle = '#ffffff';
    pen.lineWidth = 1;
    for (const taxel of this.masked) {
      const [x, y] = this.place(taxel);
      pen.beginPath();
      pen.moveTo(x + 3, y + 3);
      pen.lineTo(x + CELL - 3, y + CELL - 3);
      pen.moveTo(x + CELL - 3, y + 3);
      pen.lineTo(x + 3, y + CELL - 3);
      pen.stroke();
    }
  }

  // Of skins with axes: x goes across the rows, y across the columns.
  private drawShear(pen: CanvasRenderingContext2D, taxels: Float32Array): void {
    const { axes, rows, columns } = geometryOf(this.robot);
    if (axes !== 3 || this.robot.full === 0) return;
    pen.strokeStyle = '#ffffff';
    pen.lineWidth = 1.5;
    for (let i = 0; i < rows * columns; ++i) {
      const dx = (taxels[3 * i + 1] ?? 0) / this.robot.full * CELL;
      const dy = (taxels[3 * i] ?? 0) / this.robot.full * CELL;
      if (Math.hypot(dx, dy) < 1.5) continue;
      const [x, y] = this.place(i);
      pen.beginPath();
      pen.moveTo(x + CELL / 2, y + CELL / 2);
      pen.lineTo(x + CELL / 2 + dx, y + CELL / 2 + dy);
      pen.stroke();
    }
  }

  // The border of the touched taxels, and the contact's number.
  private drawContact(pen: CanvasRenderingContext2D, contact: FeltContact): void {
    const { columns } = geometryOf(this.robot);
    const touched = new Set(contact.patch.taxels);
    pen.beginPath();
    for (const taxel of touched) {
      const [x, y] = this.place(taxel);
      const column = taxel % columns;
      if (!touched.has(taxel - columns)) line(pen, x, y, x + CELL, y);
      if (!touched.has(taxel + columns)) {
        line(pen, x, y + CELL, x + CELL, y + CELL);
      }
      if (column === 0 || !touched.has(taxel - 1)) {
        line(pen, x, y, x, y + CELL);
      }
      if (column === columns - 1 || !touched.has(taxel + 1)) {
        line(pen, x + CELL, y, x + CELL, y + CELL);
      }
    }
    // A dark line within a light one is seen on every colour.
    pen.strokeStyle = '#000000';
    pen.lineWidth = 5;
    pen.stroke();
    pen.strokeStyle = '#ffffff';
    pen.lineWidth = 2.5;
    pen.stroke();
    if (touched.size === 0) return;
    const x = (contact.patch.centroid_column + 0.5) * CELL;
    const y = (contact.patch.centroid_row + 0.5) * CELL;
    pen.font = `600 ${1.4 * CELL}px system-ui, sans-serif`;
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.lineWidth = 4;
    pen.strokeStyle = '#000000';
    pen.strokeText(contact.id, x, y);
    pen.fillStyle = '#ffffff';
    pen.fillText(contact.id, x, y);
  }

  private drawPicked(pen: CanvasRenderingContext2D): void {
    if (this.picked === undefined) return;
    const [x, y] = this.place(this.picked);
    pen.lineWidth = 3;
    pen.strokeStyle = '#ff4fa3';
    pen.strokeRect(x + 1.5, y + 1.5, CELL - 3, CELL - 3);
  }

  private describe(felt: FeltContact[]): void {
    const unit = unitOf(geometryOf(this.robot));
    const largest = Math.max(0, ...felt.map((c) => c.patch.max_force));
    const text = felt.length === 0 ? 'no contact' :
      `${felt.length} contact${felt.length > 1 ? 's' : ''}, ` +
      `largest load ${number(largest)} ${unit}`;
    const label = `skin of ${this.robot.name}: ${text}`;
    if (this.lines.getAttribute('aria-label') !== label) {
      this.lines.setAttribute('aria-label', label);
    }
  }
}

function line(pen: CanvasRenderingContext2D, x0: number, y0: number,
    x1: number, y1: number): void {
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
}
