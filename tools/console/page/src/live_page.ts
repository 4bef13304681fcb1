// The live page: a tile for each robot, or one robot in full.

import { Announcer } from './announcer';
import { Live } from './connection';
import { byId, element, setText } from './dom';
import { stalenessOf } from './facts';
import { foxgloveButton } from './foxglove';
import { FullView } from './full_view';
import { History } from './history';
import { forgetDrawn, noteMessage } from './measures';
import type { Decoded } from './messages';
import type { Page, PageKind } from './page';
import { Robots, type Robot } from './robots';
import { Tile } from './tile';
import { isFelt, plural } from './words';

// Texts about all robots change so often.
const STATE_MS = 250;

export const LIVE: PageKind = {
  id: '',
  title: 'Live',
  ofOneServer: false,
  open: ({ main, onSignedOut }) => new LivePage(main, onSignedOut),
};

class LivePage implements Page {
  private readonly robots = new Robots();
  private readonly tiles = new Map<string, Tile>();
  private readonly grid = element('div', { class: 'grid' });
  private readonly list = element('div', { class: 'live' },
    element('h1', { class: 'unseen' }, 'Robots'), this.grid);
  private readonly tools = element('p', { class: 'live-tools' },
    foxgloveButton());
  private readonly empty = emptyText();
  private readonly loading = element('p', { class: 'loading quiet' },
    'Waiting for the console ...');
  private readonly tileOf = new WeakMap<Element, Tile>();
  private readonly histories = new WeakMap<Robot, History>();
  private readonly announcer = new Announcer();
  private readonly observer: IntersectionObserver;
  private readonly live: Live;
  private full?: FullView;
  private lost = false;
  private heard = false;
  private stateAt = -Infinity;
  private animation = 0;

  constructor(private readonly main: HTMLElement, onSignedOut: () => void) {
    this.empty.hidden = true;
    this.list.append(this.loading, this.empty, this.tools);
    main.replaceChildren(this.list);
    this.observer = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const tile = this.tileOf.get(target);
        if (tile) tile.seen = isIntersecting;
      }
    });
    this.live = new Live({
      onMessage: (decoded) => this.take(decoded),
      onLost: () => {
        this.lost = true;
        this.robots.lose();
      },
      onSignedOut,
    });
    window.addEventListener('hashchange', this.route);
    window.addEventListener('keydown', this.onKey);
    this.loop();
  }

  close(): void {
    this.live.stop();
    cancelAnimationFrame(this.animation);
    this.observer.disconnect();
    window.removeEventListener('hashchange', this.route);
    window.removeEventListener('keydown', this.onKey);
    this.full?.close();
    for (const tile of this.tiles.values()) tile.close();
  }

  private take(decoded: Decoded): void {
    this.lost = false;
    this.heard = true;
    noteMessage();
    const fresh = this.robots.take(decoded, performance.now());
    for (const robot of fresh) this.historyOf(robot).add();
    this.followRobot();
  }

  // Draws what has come, then asks for more.
  private readonly loop = (): void => {
    this.animation = requestAnimationFrame(this.loop);
    const now = performance.now();
    if (now - this.stateAt > STATE_MS) {
      this.stateAt = now;
      this.showState(now);
    }
    if (this.full) {
      this.full.update(now);
    } else {
      this.layTiles();
      for (const tile of this.tiles.values()) tile.update(now);
    }
    this.live.askNext();
  };

  // Adds tiles of new robots, and removes those of robots that are gone.
  private layTiles(): void {
    const robots = this.robots.sorted();
    for (const [key, tile] of this.tiles) {
      if (this.robots.byKey.get(key) === tile.robot) continue;
      this.observer.unobserve(tile.root);
      tile.close();
      tile.root.remove();
      this.tiles.delete(key);
      forgetDrawn(key);
    }
    robots.forEach((robot, i) => {
      let tile = this.tiles.get(robot.key);
      if (tile === undefined) {
        tile = new Tile(robot);
        this.tiles.set(robot.key, tile);
        this.tileOf.set(tile.root, tile);
        this.observer.observe(tile.root);
      }
      const there = this.grid.children[i];
      if (there !== tile.root) this.grid.insertBefore(tile.root, there ?? null);
    });
    this.loading.hidden = this.heard;
    const connected = this.robots.servers.find(
      (server) => server.state === 'connected');
    this.empty.hidden = robots.length > 0 || connected === undefined;
    if (connected) {
      setText(this.empty.querySelector('.server')!, connected.address);
    }
  }

  private showState(now: number): void {
    const all = [...this.robots.byKey.values()];
    const fresh = all.filter((robot) => stalenessOf(robot, now) === '');
    const count = fresh.length === all.length ? plural(all.length, 'robot') :
      `${fresh.length} of ${plural(all.length, 'robot')} streaming`;
    setText(byId('summary'), this.heard && all.length > 0 ? count : '');
    const trouble = this.lost ?
      ['The console does not answer. Reconnecting ...'] :
      this.robots.servers.filter((server) => server.state !== 'connected')
        .map(({ address, state, error }) => `${address}: ` +
          (state === 'refused' ? 'refused' : 'connecting again') +
          (error ? ` (${error})` : ''));
    byId('notice').hidden = trouble.length === 0;
    setText(byId('notice'), trouble.join('\n'));
    if (!this.heard) return;
    this.announcer.say(this.full ? wordsOf(this.full.robot, now) :
      all.length === 0 ? 'No robots.' : `${count}.`, now);
  }

  // A robot that comes again is shown in place of its former stream, and one
  // that is named in the address as soon as it comes.
  private followRobot(): void {
    if (this.full === undefined) return this.route();
    const { robot, isPaused } = this.full;
    if (isPaused || this.robots.byKey.get(robot.key) === robot) return;
    const successor = this.robots.successorOf(robot) ??
      this.robots.byKey.get(robot.key);
    if (successor === undefined) return;
    history.replaceState(null, '', `#robot=${encodeURIComponent(
      successor.key)}`);
    this.open(successor);
  }

  private readonly route = (): void => {
    const key = keyOfAddress();
    if (key === undefined) return this.openList();
    // A robot that is gone stays in sight until somebody leaves it.
    if (this.full?.robot.key === key) return;
    const robot = this.robots.byKey.get(key);
    if (robot) this.open(robot);
    else this.openList();
  };

  private historyOf(robot: Robot): History {
    let history = this.histories.get(robot);
    if (history === undefined) {
      history = new History(robot);
      this.histories.set(robot, history);
    }
    return history;
  }

  private open(robot: Robot): void {
    this.full?.close();
    this.full = new FullView(robot, this.historyOf(robot));
    this.main.replaceChildren(this.full.root);
    this.main.focus();
    window.scrollTo(0, 0);
    this.stateAt = -Infinity;
  }

  private openList(): void {
    if (this.full === undefined) return;
    const { key } = this.full.robot;
    this.full.close();
    this.full = undefined;
    this.main.replaceChildren(this.list);
    this.layTiles();
    const tile = this.tiles.get(key);
    if (tile) tile.link.focus();
    else this.main.focus();
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    if (this.full === undefined || event.ctrlKey || event.altKey ||
        event.metaKey) {
      return;
    }
    if (event.key === 'Escape') location.hash = '';
    else this.full.onKey(event);
  };
}

// The robot's key in the address; undefined if there is none.
function keyOfAddress(): string | undefined {
  const match = /^#robot=(.+)$/.exec(location.hash);
  if (!match) return undefined;
  try {
    return decodeURIComponent(match[1]!);
  } catch {
    return undefined;
  }
}

// What a robot does, for people who listen.
function wordsOf(robot: Robot, now: number): string {
  const stale = stalenessOf(robot, now);
  if (stale) return `${robot.name}: ${stale.replace(/ .*/, '')}.`;
  const felt = (robot.frame?.answer.contacts ?? []).filter(isFelt);
  if (felt.length === 0) return `${robot.name}: no contact.`;
  const { questions } = robot.stream.started;
  const decided = felt[0]!.answers.map((answer, q) => answer.decision ?
    `${questions[q]?.name} ${questions[q]?.values[answer.decision.value]}` :
    '').filter((text) => text !== '');
  return `${robot.name}: ${plural(felt.length, 'contact')}` +
    (decided.length > 0 ? `, ${decided.join(', ')}.` : '.');
}

function emptyText(): HTMLElement {
  return element('section', { class: 'empty' },
    element('h2', {}, 'No robot is streaming'),
    element('p', {}, 'Start a simulated one:'),
    element('pre', {}, 'tactus-stream --server=',
      element('span', { class: 'server' }),
      ' --driver=sim --rate=real --client-id=arm-1 --trials=1000'),
    element('p', { class: 'quiet' }, 'It appears here as soon as it streams.'));
}
