// A contact that is answered once more: its frames, and series of them for
// curves. Times are seconds since the contact's onset.

import type { Contact, WatchedEvent } from '../messages';
import { loadOf, roundUp, type Robot } from '../robots';
import { isFelt } from '../words';
import { floatsOf } from './bytes';
import type { Replayed } from './messages';
import { robotOf } from './texts';

export interface Moment {
  time: number;
  taxels: Float32Array;
  contacts: Contact[];
  // The logged contact in this replay, while there is one.
  shown?: Contact;
}

export class Replay {
  // As the live page's views know one.
  readonly robot: Robot;
  readonly moments: Moment[];

  constructor(readonly replayed: Replayed) {
    const { contact, frames, started, contact_id } = replayed;
    const onset = frames.find(({ answer }) =>
      answer.sequence === contact.onset_sequence) ?? frames[0];
    this.robot = {
      key: contact.name, name: robotOf(contact), server: 0,
      stream: { stream_id: '', client_id: contact.robot, sample_rate_hz: 0,
        start_time_ms: contact.begin_time_ms, started },
      countsAt: 0, taxels: new Float32Array(0), frames: 0, frameAt: 0,
      frameAge: 0, full: 0, events: [], eventCount: 0, offline: false,
      beginNs: Number(onset?.answer.capture_time_ns ?? 0),
    };
    this.moments = frames.map(({ answer, taxels }): Moment => ({
      time: (Number(answer.capture_time_ns) - this.robot.beginNs!) / 1e9,
      taxels: floatsOf(taxels), contacts: answer.contacts,
      shown: answer.contacts.find(({ id }) => id === contact_id),
    }));
    this.robot.full = roundUp(Math.max(0, ...this.moments.map(({ taxels }) =>
      this.mostOf(taxels))));
    this.robot.events = frames.flatMap(({ answer }) =>
      (answer.events ?? []).map((event): WatchedEvent => ({ event,
        sequence: answer.sequence, capture_time_ns: answer.capture_time_ns,
        time_since_onset_ns: answer.contacts.find(({ id }) =>
          id === event.contact_id)?.time_since_onset_ns ?? '0' })));
    this.robot.eventCount = this.robot.events.length;
  }

  get times(): number[] { return this.moments.map(({ time }) => time); }

  get force(): number[] {
    return this.moments.map(({ shown }) =>
      shown && isFelt(shown) ? shown.patch.force : 0);
  }

  // Of each value of a question; none where there is no such contact.
  answers(question: number): (number | null)[][] {
    const { values } = this.robot.stream.started.questions[question]!;
    return values.map((_, value) => this.moments.map(({ shown }) =>
      shown?.answers[question]?.probability[value] ?? null));
  }

  // The moment of the largest load, as on the contact's picture.
  get strongest(): number {
    const { force } = this;
    return Math.max(0, force.indexOf(Math.max(0, ...force)));
  }

  // The moment that is shown at a time.
  at(time: number): number {
    const { moments } = this;
    let i = 0;
    while (i + 1 < moments.length && moments[i + 1]!.time <= time) ++i;
    return i;
  }

  private mostOf(taxels: Float32Array): number {
    const { rows, columns } = this.robot.stream.started.geometry;
    let most = 0;
    for (let i = 0; i < rows * columns; ++i) {
      most = Math.max(most, loadOf(this.robot, taxels, i));
    }
    return most;
  }
}
