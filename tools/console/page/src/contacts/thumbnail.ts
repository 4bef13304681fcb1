// A contact's picture, small, in the colours of the live page.

import { COLORS } from '../color_map';
import { element } from '../dom';
import { bytesOf } from './bytes';
import type { Picture } from './messages';

export function thumbnail(picture?: Picture | null): HTMLElement {
  const box = element('div', { class: 'thumbnail' });
  if (!picture || picture.rows === 0 || picture.columns === 0) return box;
  const { rows, columns } = picture;
  const canvas = element('canvas', { width: String(columns),
    height: String(rows), 'aria-hidden': 'true' });
  const image = new ImageData(columns, rows);
  const pixels = new Uint32Array(image.data.buffer);
  const loads = bytesOf(picture.loads);
  // By the square root, as on the live page.
  for (let i = 0; i < pixels.length; ++i) {
    pixels[i] = COLORS[Math.round(Math.sqrt((loads[i] ?? 0) / 255) *
      (COLORS.length - 1))]!;
  }
  canvas.getContext('2d')!.putImageData(image, 0, 0);
  box.append(canvas);
  return box;
}
