// The robots that the page knows, from the console's messages.

import type { Contact, Counts, Decoded, Frame, Geometry, OpenStream,
  ServerState, WatchedEvent } from './messages';
import { isFelt, isReleased } from './words';

// How long a stream that has ended stays in sight.
const ENDED_MS = 30_000;
// A server that is back names its streams anew within this time.
const RETURN_MS = 2_000;
// Events that a robot keeps.
const MOST_EVENTS = 500;
// The scale of a skin begins at so many contact thresholds: noise stays dark.
const LEAST_SCALE = 20;

export interface Robot {
  // Of the page, unique.
  key: string;
  name: string;
  server: number;
  stream: OpenStream;
  counts?: Counts;
  // When the counts came, by performance.now().
  countsAt: number;
  frame?: Frame;
  taxels: Float32Array;
  // Frames that came.
  frames: number;
  // When the newest frame came, and its age then, in milliseconds.
  frameAt: number;
  frameAge: number;
  // The end of the skin's scale. It never shrinks, so that colours keep their
  // meaning.
  full: number;
  // Capture time of the stream's beginning, by the robot's clock.
  beginNs?: number;
  events: WatchedEvent[];
  // Events that came, also those that are kept no more.
  eventCount: number;
  // The last contact that was felt, or what was said of it at its end.
  last?: Contact;
  endedAt?: number;
  // Its server or the console does not answer.
  offline: boolean;
  // The server is back; the robot goes then if it is not named anew.
  awaitedUntil?: number;
}

export function geometryOf(robot: Robot): Geometry {
  return robot.stream.started.geometry;
}

export function axesOf(robot: Robot): number {
  return Math.max(geometryOf(robot).axes, 1);
}

// The load of a taxel, as the server has it: the value of the normal axis, or
// the distance of its values from 0.
export function loadOf(robot: Robot, taxels: Float32Array, i: number): number {
  const axes = axesOf(robot);
  if (axes === 1) return taxels[i] ?? 0;
  const normal = geometryOf(robot).normal_axis;
  const at = (axis: number) => taxels[i * axes + axis] ?? 0;
  if (typeof normal === 'number') return Math.max(at(normal), 0);
  return Math.hypot(at(0), at(1), at(2));
}

// Seconds since the stream's beginning, by the robot's clock.
export function timeOf(robot: Robot, captureNs: string): number {
  return (Number(captureNs) - (robot.beginNs ?? 0)) / 1e9;
}

// Milliseconds since the robot's last message.
export function silentMs(robot: Robot, now: number): number {
  if (robot.counts === undefined) return 0;
  return Number(robot.counts.silent_ms) + now - robot.countsAt;
}

export class Robots {
  readonly byKey = new Map<string, Robot>();
  servers: ServerState[] = [];

  // Takes a message; returns the robots of which there is a new frame.
  take({ message, taxels }: Decoded, now: number): Robot[] {
    const before = this.servers;
    this.servers = message.servers;
    const fresh: Robot[] = [];
    for (const { server, taxels: begin, update } of message.updates) {
      const key = `${server}/${update.stream_id}`;
      if (update.opened) this.open(key, server, update.opened);
      const robot = this.byKey.get(key);
      if (robot === undefined) continue;
      if (update.counts) {
        robot.counts = update.counts;
        robot.countsAt = now;
      }
      if (update.frame) {
        robot.frame = update.frame;
        robot.frameAt = now;
        robot.frameAge =
          (Number(update.frame.age_us) + message.waited_us) / 1000;
        ++robot.frames;
        robot.beginNs ??= beginOf(robot, message.console_time_ms);
        const { contacts } = update.frame.answer;
        robot.last =
          contacts.find(isFelt) ?? contacts.find(isReleased) ?? robot.last;
        if (begin >= 0) this.setTaxels(robot, taxels, begin);
        fresh.push(robot);
      }
      robot.eventCount += update.events.length;
      robot.events.push(...update.events);
      robot.events.splice(0, robot.events.length - MOST_EVENTS);
      if (update.ended) {
        robot.endedAt = now;
        this.forgetFormer(robot);
      }
    }
    this.servers.forEach((server, i) => this.follow(i,
      server.state === 'connected', before[i]?.state === 'connected', now));
    this.forgetGone(now);
    return fresh;
  }

  // The console is lost: what it told is old.
  lose(): void {
    this.servers = this.servers.map((server) =>
      ({ ...server, state: 'connecting' }));
    for (const robot of this.byKey.values()) robot.offline = true;
  }

  // In the order of their names.
  sorted(): Robot[] {
    return [...this.byKey.values()].sort((a, b) =>
      a.name.localeCompare(b.name, 'en', { numeric: true }) ||
      a.key.localeCompare(b.key));
  }

  // The robot that has taken the place of one that is gone.
  successorOf(former: Robot): Robot | undefined {
    return [...this.byKey.values()].find((robot) => robot !== former &&
      robot.server === former.server && robot.name === former.name);
  }

  private open(key: string, server: number, stream: OpenStream): void {
    const known = this.byKey.get(key);
    if (known?.stream.start_time_ms === stream.start_time_ms) {
      // The same stream: the server or the console was away, not the robot. Its
      // events come anew.
      Object.assign(known, { stream, offline: false, events: [],
        awaitedUntil: undefined });
      return;
    }
    const robot: Robot = {
      key, name: stream.client_id || `stream ${stream.stream_id}`, server,
      stream, countsAt: 0, taxels: new Float32Array(0), frames: 0, frameAt: 0,
      frameAge: 0, events: [], eventCount: 0, offline: false,
      full: roundUp(LEAST_SCALE * stream.started.geometry.contact_threshold),
    };
    this.byKey.set(key, robot);
    for (const former of [...this.byKey.values()]) {
      if (former !== robot) this.forgetFormer(former);
    }
  }

  // A robot that comes again takes the place of its former stream.
  private forgetFormer(robot: Robot): void {
    const over = robot.endedAt !== undefined || robot.offline;
    if (over && this.successorOf(robot)) this.byKey.delete(robot.key);
  }

  // Marks the robots of a server that is away, and those that it has not named
  // since it is back.
  private follow(
      server: number, is: boolean, was: boolean, now: number): void {
    for (const robot of this.byKey.values()) {
      if (robot.server !== server) continue;
      if (!is) {
        robot.offline = true;
        robot.awaitedUntil = undefined;
      } else if (!was && robot.offline) {
        robot.awaitedUntil = now + RETURN_MS;
      }
    }
  }

  private setTaxels(robot: Robot, all: Float32Array, begin: number): void {
    const { rows, columns } = geometryOf(robot);
    const taxels = rows * columns;
    robot.taxels = all.slice(begin, begin + taxels * axesOf(robot));
    let most = 0;
    for (let i = 0; i < taxels; ++i) {
      most = Math.max(most, loadOf(robot, robot.taxels, i));
    }
    if (most > robot.full) robot.full = roundUp(most);
  }

  private forgetGone(now: number): void {
    for (const [key, robot] of this.byKey) {
      const ended = robot.endedAt !== undefined &&
        now - robot.endedAt > ENDED_MS;
      const missed = robot.awaitedUntil !== undefined &&
        now > robot.awaitedUntil;
      if (ended || missed) this.byKey.delete(key);
    }
  }
}

// The capture time at which a stream began: its age by the clocks of server and
// console, before the capture of its newest frame.
function beginOf(robot: Robot, consoleMs: number): number {
  const age = consoleMs - Number(robot.stream.start_time_ms) - robot.frameAge;
  const capture = Number(robot.frame!.answer.capture_time_ns);
  return capture - Math.max(age, 0) * 1e6;
}

// The next of 1, 2, 5, 10, ... so that the scale changes seldom.
export function roundUp(load: number): number {
  if (!(load > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(load));
  for (const step of [1, 2, 5]) {
    if (load <= step * power) return Number((step * power).toPrecision(1));
  }
  return Number((10 * power).toPrecision(1));
}
