// The last minutes of the robot that is viewed: frames for scrubbing, and
// series for curves.

import type { Contact } from './messages';
import { geometryOf, type Robot } from './robots';
import { contactOf } from './tile';
import { isFelt, type FeltContact } from './words';

const LENGTH_S = 180;
const MOST_FRAMES = LENGTH_S * 30;

export interface Moment {
  // Seconds since the first moment, by the robot's clock.
  time: number;
  sequence: number;
  taxels: Float32Array;
  contacts: Contact[];
}

export class History {
  readonly moments: Moment[] = [];
  private begin?: number;

  // Adds the robot's newest frame.
  add(robot: Robot): void {
    const answer = robot.frame?.answer;
    if (answer === undefined) return;
    const capture = Number(answer.capture_time_ns) / 1e9;
    this.begin ??= capture;
    this.moments.push({
      time: capture - this.begin, sequence: Number(answer.sequence),
      taxels: robot.taxels, contacts: answer.contacts,
    });
    if (this.moments.length > MOST_FRAMES) this.moments.shift();
  }

  // Time of an event, in seconds since the first moment.
  timeOf(captureNs: string): number {
    return Number(captureNs) / 1e9 - (this.begin ?? 0);
  }

  times(): number[] {
    return this.moments.map((moment) => moment.time);
  }

  // A number of each moment; null leaves a gap in a curve.
  series(read: (moment: Moment) => number | null): (number | null)[] {
    return this.moments.map(read);
  }
}

// The largest contact that is felt at a moment.
export function largest(moment: Moment): FeltContact | undefined {
  return moment.contacts.filter(isFelt)
    .sort((a, b) => b.patch.force - a.patch.force)[0];
}

export function lastContact(history: History, robot: Robot):
    Contact | undefined {
  for (let i = history.moments.length - 1; i >= 0; --i) {
    const contact = largest(history.moments[i]!);
    if (contact !== undefined) return contact;
  }
  return contactOf(robot);
}

export function taxelCount(robot: Robot): number {
  const { rows, columns } = geometryOf(robot);
  return rows * columns;
}
