// How long frames take from the server to the screen, for tests: nothing of it
// is shown.

import type { Robot } from './robots';

declare global {
  interface Window {
    tactus: {
      // Milliseconds from the server to the screen of the last frames, in no
      // order.
      readonly delays: Float64Array;
      framesDrawn: number;
      messages: number;
      // Drawn frames by a robot's key.
      drawn: Map<string, number>;
    };
  }
}

const ring = new Float64Array(4096);

window.tactus = {
  get delays() {
    return ring.subarray(0, Math.min(this.framesDrawn, ring.length));
  },
  framesDrawn: 0, messages: 0, drawn: new Map(),
};

export function noteMessage(): void { ++window.tactus.messages; }

export function noteDrawn(robot: Robot): void {
  const { drawn } = window.tactus;
  ring[window.tactus.framesDrawn++ % ring.length] =
    robot.frameAge + performance.now() - robot.frameAt;
  drawn.set(robot.key, (drawn.get(robot.key) ?? 0) + 1);
}

export function forgetDrawn(key: string): void {
  window.tactus.drawn.delete(key);
}
