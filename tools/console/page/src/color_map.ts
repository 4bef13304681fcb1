// Cividis: a scale from dark blue to yellow whose brightness rises evenly, also
// for people who see fewer colours.

// Red, green and blue at nine even places.
const ANCHORS = [
  [0, 32, 77], [17, 54, 112], [60, 77, 110], [98, 100, 111], [124, 123, 120],
  [151, 147, 119], [187, 173, 108], [224, 201, 86], [255, 234, 70],
] as const;

const STEPS = 256;

// Colours as canvas pixels, 0xAABBGGRR, at even places of the scale.
export const COLORS: Uint32Array = makeColors();

function makeColors(): Uint32Array {
  const colors = new Uint32Array(STEPS);
  for (let i = 0; i < STEPS; ++i) {
    const place = (i / (STEPS - 1)) * (ANCHORS.length - 1);
    const low = Math.min(Math.floor(place), ANCHORS.length - 2);
    const a = ANCHORS[low]!;
    const b = ANCHORS[low + 1]!;
    const mix = (k: 0 | 1 | 2) =>
      Math.round(a[k] + (b[k] - a[k]) * (place - low));
    colors[i] = 0xff000000 | (mix(2) << 16) | (mix(1) << 8) | mix(0);
  }
  return colors;
}

// The colour of a load between 0 and `full`. The scale goes by the square root,
// so that a light touch is seen beside a heavy one: a quarter of the full load
// is in its middle.
export function colorOf(load: number, full: number): number {
  const part = full > 0 ? Math.min(Math.max(load / full, 0), 1) : 0;
  return COLORS[Math.round(Math.sqrt(part) * (STEPS - 1))]!;
}
