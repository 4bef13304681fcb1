// The last frames of a robot for scrubbing, and series of them for curves.
// Their memory is bounded: the robot that is viewed keeps 3 minutes of 30
// frames a second, each other one 10 seconds, so that there is something to see
// when it is opened. Large skins keep less.

import type { Contact } from './messages';
import { axesOf, geometryOf, loadOf, timeOf, type Robot } from './robots';
import { isFelt } from './words';

interface Bounds {
  seconds: number;
  taxelBytes: number;
}

const VIEWED: Bounds = { seconds: 180, taxelBytes: 64 << 20 };
const OTHERS: Bounds = { seconds: 10, taxelBytes: 1 << 20 };
const FRAMES_PER_S = 30;

export interface Moment {
  // Seconds since the stream's beginning.
  time: number;
  taxels: Float32Array;
  contacts: Contact[];
}

export type Series = (number | null)[];

export class History {
  readonly moments: Moment[] = [];
  // Of the same length as `moments`.
  readonly times: number[] = [];
  readonly force: Series = [];
  readonly largest: Series = [];
  readonly area: Series = [];
  // By question and value; null without a contact.
  readonly answers: Series[][];
  // Moments that are forgotten: `first + i` names moments[i] for ever.
  first = 0;
  private bounds = OTHERS;

  constructor(private readonly robot: Robot) {
    this.answers = robot.stream.started.questions.map((question) =>
      question.values.map(() => []));
  }

  get end(): number { return this.first + this.moments.length; }

  at(index: number): Moment | undefined {
    return this.moments[index - this.first];
  }

  // Adds the robot's newest frame.
  add(): void {
    const answer = this.robot.frame?.answer;
    if (answer === undefined) return;
    const time = timeOf(this.robot, answer.capture_time_ns);
    // A frame that comes again, after the console was away.
    if (time <= (this.times[this.times.length - 1] ?? -Infinity)) return;
    const { contacts } = answer;
    const contact = contacts.find(isFelt);
    this.moments.push({ time, taxels: this.robot.taxels, contacts });
    this.times.push(time);
    this.force.push(contact?.patch.force ?? 0);
    this.largest.push(contact?.patch.max_force ?? 0);
    this.area.push(contact?.patch.area_taxels ?? 0);
    this.answers.forEach((values, q) => values.forEach((series, v) =>
      series.push(contact?.answers[q]?.probability[v] ?? null)));
    this.forget();
  }

  // Keeps more while somebody views the robot.
  setViewed(viewed: boolean): void {
    this.bounds = viewed ? VIEWED : OTHERS;
    this.forget();
  }

  // Loads of one taxel.
  loads(taxel: number, from: number, to: number): Series {
    return this.moments.slice(from, to).map((moment) =>
      loadOf(this.robot, moment.taxels, taxel));
  }

  // The index of the moment that is nearest to a time.
  nearest(time: number): number {
    const i = this.lowerBound(time);
    const before = time - (this.times[i - 1] ?? -Infinity);
    const after = (this.times[i] ?? Infinity) - time;
    return this.first + (before < after ? i - 1 : i);
  }

  // The first place in `times` that is not before a time.
  lowerBound(time: number): number {
    let low = 0;
    let high = this.times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle]! < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private forget(): void {
    const { rows, columns } = geometryOf(this.robot);
    const bytes = 4 * rows * columns * axesOf(this.robot);
    const { seconds, taxelBytes } = this.bounds;
    const most = Math.min(seconds * FRAMES_PER_S, taxelBytes / bytes);
    const oldest = (this.times[this.times.length - 1] ?? 0) - seconds;
    while (this.moments.length > most || this.times[0]! < oldest) {
      this.forgetOne();
    }
  }

  private forgetOne(): void {
    ++this.first;
    this.moments.shift();
    this.times.shift();
    this.force.shift();
    this.largest.shift();
    this.area.shift();
    for (const values of this.answers) {
      for (const series of values) series.shift();
    }
  }
}
