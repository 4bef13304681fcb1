// The live page: a tile for each robot, or one robot in full.

import { Live } from './connection';
import { byId, element, setText } from './dom';
import { FullView } from './full_view';
import type { Decoded } from './messages';
import { Robots, type Robot } from './robots';
import { stalenessOf, Tile } from './tile';

// Delays that are kept for tests.
const MOST_DELAYS = 20_000;

export class LivePage {
  private readonly robots = new Robots();
  private readonly tiles = new Map<string, Tile>();
  private readonly grid = element('div', { class: 'grid' });
  private readonly sight = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const tile = this.tileOf.get(target);
      if (tile) tile.inSight = isIntersecting;
    }
  });
  private readonly tileOf = new WeakMap<Element, Tile>();
  private readonly live: Live;
  private full?: FullView;
  private lost = false;
  private heard = false;
  private received = 0;
  private frame = 0;

  constructor(private readonly main: HTMLElement,
      onSignedOut: (reason: string) => void) {
    main.replaceChildren(this.grid);
    this.live = new Live({
      onMessage: (decoded) => this.take(decoded),
      onLost: () => { this.lost = true; },
      onSignedOut,
    });
    window.addEventListener('hashchange', this.route);
    window.addEventListener('keydown', this.onKey);
    this.loop();
  }

  close(): void {
    this.live.stop();
    cancelAnimationFrame(this.frame);
    window.removeEventListener('hashchange', this.route);
    window.removeEventListener('keydown', this.onKey);
    this.full?.close();
    this.sight.disconnect();
  }

  private take(decoded: Decoded): void {
    this.lost = false;
    this.heard = true;
    this.received = performance.now();
    const fresh = this.robots.take(decoded, this.received);
    if (this.full && fresh.includes(this.full.robot)) this.full.take();
    const waited = decoded.message.waited_us / 1000;
    for (const robot of fresh) {
      this.waiting.push(Number(robot.frame!.age_us) / 1000 + waited);
    }
    ++window.tactus.messages;
  }

  // Delays of frames that came and are not drawn yet, without the drawing.
  private waiting: number[] = [];

  private readonly loop = (): void => {
    this.frame = requestAnimationFrame(this.loop);
    const now = performance.now();
    this.showState(now);
    this.followRobot();
    if (this.full) {
      this.full.update(now);
    } else {
      this.layTiles();
      for (const tile of this.tiles.values()) {
        if (tile.update(now)) ++window.tactus.framesDrawn;
      }
    }
    const drawing = performance.now() - this.received;
    const { delays } = window.tactus;
    for (const delay of this.waiting) delays.push(delay + drawing);
    delays.splice(0, delays.length - MOST_DELAYS);
    this.waiting = [];
  };

  // Adds tiles of new robots, and removes those of robots that are gone.
  private layTiles(): void {
    const robots = this.robots.sorted();
    for (const [key, tile] of this.tiles) {
      if (this.robots.byKey.get(key) === tile.robot) continue;
      this.sight.unobserve(tile.root);
      tile.root.remove();
      this.tiles.delete(key);
    }
    robots.forEach((robot, i) => {
      let tile = this.tiles.get(robot.key);
      if (tile === undefined) {
        tile = new Tile(robot);
        this.tiles.set(robot.key, tile);
        this.tileOf.set(tile.root, tile);
        this.sight.observe(tile.root);
      }
      const there = this.grid.children[i];
      if (there !== tile.root) this.grid.insertBefore(tile.root, there ?? null);
    });
    if (robots.length > 0 || !this.heard) {
      this.main.querySelector('.empty')?.remove();
    } else if (this.main.querySelector('.empty') === null) {
      this.main.append(emptyText());
    }
  }

  // Shows the next stream of the robot that is viewed, if that has ended.
  private followRobot(): void {
    const robot = this.full?.robot;
    if (!robot || this.robots.byKey.get(robot.key) === robot) return;
    const next = this.robots.successorOf(robot);
    if (next) this.view(next);
  }

  private view(robot: Robot | undefined): void {
    this.full?.close();
    this.full = robot ? new FullView(robot) : undefined;
    this.main.replaceChildren(this.full?.root ?? this.grid);
  }

  private showState(now: number): void {
    const all = [...this.robots.byKey.values()];
    const fine = all.filter((robot) => stalenessOf(robot, now) === '').length;
    setText(byId('summary'), !this.heard ? '' :
      `${fine} of ${all.length} robots send`);
    const notice = byId('notice');
    const trouble = this.lost ? ['The console does not answer. Reconnecting ...']
      : this.robots.servers.filter((server) => server.state !== 'connected')
        .map((server) => `${server.address}: ${server.state}` +
          (server.error ? ` (${server.error})` : ''));
    notice.hidden = trouble.length === 0;
    setText(notice, trouble.join('\n'));
  }

  private readonly route = (): void => {
    const match = /^#robot=(.+)$/.exec(location.hash);
    const robot = match ?
      this.robots.byKey.get(decodeURIComponent(match[1]!)) : undefined;
    if (robot === this.full?.robot) return;
    this.view(robot);
    this.main.focus();
    window.scrollTo(0, 0);
  };

  private readonly onKey = (event: KeyboardEvent): void => {
    if (this.full === undefined) return;
    if (event.key === 'Escape') location.hash = '';
    else this.full.onKey(event);
  };
}

function emptyText(): HTMLElement {
  return element('div', { class: 'empty' },
    element('h1', {}, 'No robot is streaming'),
    element('p', {}, 'This starts a simulated one:'),
    element('pre', {}, 'tactus-stream --driver=sim --rate=real ' +
      '--client-id=arm-1 --trials=1000'),
    element('p', { class: 'quiet' }, 'It appears here as soon as it streams.'));
}
