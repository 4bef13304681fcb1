// Compares pictures of pages with those that are kept, with a tolerance.
//
// What is kept is small: the mean luminance of squares of 16 x 16 pixels. So a
// page that looks like before passes on another machine, where the edges of
// letters differ, and a drawing that is gone, a colour that is wrong, or a card
// in another place does not.

import { existsSync } from 'node:fs';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { dirname } from 'node:path';

const SQUARE = 16;
// Luminances that differ by no more are the same, of 255.
const SAME = 10;
// So many squares may differ, as a fraction.
const MOST_DIFFERENT = 0.005;

export class PictureComparison {
  // A page of no address decodes and encodes pictures.
  static async make(browser) {
    return new PictureComparison(await browser.newPage());
  }

  constructor(page) { this.page = page; }

  close() { return this.page.close(); }

  // { width, height, values }: luminances of squares, row by row. `square`: 1
  // for a picture that was shrunk before.
  async shrink(png, square = SQUARE) {
    return this.page.evaluate(async ([url, side]) => {
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = document.createElement('canvas');
      canvas.width = image.width;
      canvas.height = image.height;
      const pen = canvas.getContext('2d', { willReadFrequently: true });
      pen.drawImage(image, 0, 0);
      const { data } = pen.getImageData(0, 0, image.width, image.height);
      const width = Math.floor(image.width / side);
      const height = Math.floor(image.height / side);
      const values = new Array(width * height).fill(0);
      for (let y = 0; y < height * side; ++y) {
        for (let x = 0; x < width * side; ++x) {
          const i = 4 * (y * image.width + x);
          values[Math.floor(y / side) * width + Math.floor(x / side)] +=
            0.2126 * data[i] + 0.7152 * data[i + 1] + 0.0722 * data[i + 2];
        }
      }
      return { width, height, values: values.map((value) =>
        Math.round(value / (side * side))) };
    }, [`data:image/png;base64,${png.toString('base64')}`, square]);
  }

  // What is different; empty if the pictures are the same but for the tolerance.
  async compare(png, keptFile) {
    if (!existsSync(keptFile)) return 'there is no picture to compare with';
    return differenceOf(await this.shrink(png),
      await this.shrink(await readFile(keptFile), 1));
  }

  async keep(png, keptFile) {
    const shrunk = await this.shrink(png);
    const url = await this.page.evaluate(({ width, height, values }) => {
      const canvas = document.createElement('canvas');
      canvas.width = width;
      canvas.height = height;
      const image = new ImageData(width, height);
      values.forEach((value, i) =>
        image.data.set([value, value, value, 255], 4 * i));
      canvas.getContext('2d').putImageData(image, 0, 0);
      return canvas.toDataURL('image/png');
    }, shrunk);
    await mkdir(dirname(keptFile), { recursive: true });
    await writeFile(keptFile, Buffer.from(url.split(',')[1], 'base64'));
  }
}

export function differenceOf(seen, kept) {
  if (seen.width !== kept.width || Math.abs(seen.height - kept.height) > 1) {
    return `it has ${seen.width} x ${seen.height} squares, not ` +
      `${kept.width} x ${kept.height}`;
  }
  const count = seen.width * Math.min(seen.height, kept.height);
  const different = Math.max(unlike(seen, kept), unlike(kept, seen)) / count;
  return different <= MOST_DIFFERENT ? '' :
    `${(100 * different).toFixed(2)} % of its squares differ, more than ` +
      `${100 * MOST_DIFFERENT} %`;
}

// Squares of one picture that are like none at the same place of the other one,
// or beside it: a line of text may be a few pixels lower.
function unlike(one, other) {
  let count = 0;
  const height = Math.min(one.height, other.height);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < one.width; ++x) {
      const value = one.values[y * one.width + x];
      let isFound = false;
      for (let v = Math.max(y - 1, 0); v <= Math.min(y + 1, height - 1); ++v) {
        for (let u = Math.max(x - 1, 0); u <= Math.min(x + 1, one.width - 1);
          ++u) {
          isFound ||= Math.abs(other.values[v * other.width + u] - value) <=
            SAME;
        }
      }
      if (!isFound) ++count;
    }
  }
  return count;
}
