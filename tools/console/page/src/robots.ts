// The robots that the page knows, from the console's messages.

import type { Counts, Decoded, Frame, Geometry, OpenStream, ServerState,
  WatchedEvent } from './messages';

// How long a stream that has ended stays in sight.
const ENDED_MS = 30_000;
// Events that a robot keeps.
const MOST_EVENTS = 500;

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
  frameAt: number;
  // Frames that came.
  frames: number;
  // The largest load so far: the scale of the skin. It never shrinks, so that
  // colours keep their meaning.
  full: number;
  events: WatchedEvent[];
  endedAt?: number;
  offline: boolean;
}

export function geometryOf(robot: Robot): Geometry {
  return robot.stream.started.geometry;
}

// The load of a taxel, as the server has it: the value of the normal axis, or
// the distance of its values from 0.
export function loadOf(robot: Robot, taxels: Float32Array, i: number): number {
  const geometry = geometryOf(robot);
  const axes = Math.max(geometry.axes, 1);
  const at = (axis: number) => taxels[i * axes + axis] ?? 0;
  if (axes === 1) return at(0);
  if (geometry.normal_axis !== undefined) {
    return Math.max(at(geometry.normal_axis), 0);
  }
  return Math.hypot(at(0), at(1), at(2));
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
    message.servers.forEach(({ state }, server) => {
      const back = state === 'connected' &&
        this.servers[server]?.state !== 'connected';
      // What streams there comes anew; numbers of streams begin anew, too.
      if (back) this.forgetServer(server);
    });
    this.servers = message.servers;
    const drawn: Robot[] = [];
    for (const { server, taxels: begin, update } of message.updates) {
      const key = `${server}/${update.stream_id}`;
      if (update.opened) this.open(key, server, update.opened);
      const robot = this.byKey.get(key);
      if (robot === undefined) continue;
      if (update.counts) {
        robot.counts = update.counts;
        robot.countsAt = now;
      }
      robot.events.push(...update.events);
      robot.events.splice(0, robot.events.length - MOST_EVENTS);
      if (update.ended) robot.endedAt = now;
      if (!update.frame) continue;
      robot.frame = update.frame;
      robot.frameAt = now;
      ++robot.frames;
      if (begin >= 0) this.setTaxels(robot, taxels, begin);
      drawn.push(robot);
    }
    for (const robot of this.byKey.values()) {
      robot.offline = this.servers[robot.server]?.state !== 'connected';
    }
    this.forgetEnded(now);
    return drawn;
  }

  // In the order of their names.
  sorted(): Robot[] {
    return [...this.byKey.values()].sort((a, b) =>
      a.name.localeCompare(b.name, 'en', { numeric: true }) ||
      a.key.localeCompare(b.key));
  }

  // The robot of this name, for one whose stream is over.
  successorOf(robot: Robot): Robot | undefined {
    return [...this.byKey.values()].find((other) =>
      other.server === robot.server && other.name === robot.name);
  }

  private forgetServer(server: number): void {
    for (const [key, robot] of this.byKey) {
      if (robot.server === server) this.byKey.delete(key);
    }
  }

  private open(key: string, server: number, stream: OpenStream): void {
    const name = stream.client_id || `stream ${stream.stream_id}`;
    // A robot that comes again takes its former place.
    for (const [old, robot] of this.byKey) {
      const gone = robot.endedAt !== undefined;
      if (robot.server === server && gone && robot.name === name) {
        this.byKey.delete(old);
      }
    }
    this.byKey.set(key, {
      key, name, server, stream, countsAt: 0, taxels: new Float32Array(0),
      frameAt: 0, frames: 0, full: 0, events: [], offline: false,
    });
  }

  private setTaxels(robot: Robot, all: Float32Array, begin: number): void {
    const geometry = geometryOf(robot);
    const taxels = geometry.rows * geometry.columns;
    const count = taxels * Math.max(geometry.axes, 1);
    robot.taxels = all.slice(begin, begin + count);
    for (let i = 0; i < taxels; ++i) {
      const load = loadOf(robot, robot.taxels, i);
      if (load > robot.full) robot.full = roundUp(load);
    }
  }

  private forgetEnded(now: number): void {
    for (const [key, robot] of this.byKey) {
      if (robot.endedAt !== undefined && now - robot.endedAt > ENDED_MS) {
        this.byKey.delete(key);
      }
    }
  }
}

// The next of 1, 2, 5, 10, ... so that the scale changes seldom.
function roundUp(load: number): number {
  const power = 10 ** Math.floor(Math.log10(load));
  for (const step of [1, 2, 5]) if (load <= step * power) return step * power;
  return 10 * power;
}
