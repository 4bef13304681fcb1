// A robot on the live page.

import { AnswersView } from './answers';
import { element, setText } from './dom';
import type { Contact } from './messages';
import { geometryOf, silentMs, type Robot } from './robots';
import { SkinView } from './skin';
import { isFelt, modelOf, number, unitOf } from './words';

// A robot that sends nothing for so long is shown as silent.
const SILENT_MS = 1000;

// Why a robot's answers are old; empty if they are not.
export function stalenessOf(robot: Robot, now: number): string {
  if (robot.offline) return 'offline';
  if (robot.endedAt !== undefined) return 'ended';
  const silent = silentMs(robot, now);
  return silent > SILENT_MS ? `silent for ${Math.floor(silent / 1000)} s` : '';
}

// The contact to show: the largest that is felt, else the last one.
export function contactOf(robot: Robot, last?: Contact): Contact | undefined {
  const felt = (robot.frame?.answer.contacts ?? []).filter(isFelt);
  return felt.sort((a, b) => b.patch.force - a.patch.force)[0] ?? last;
}

export class Tile {
  readonly root: HTMLElement;
  private readonly skin: SkinView;
  private readonly answers: AnswersView;
  private readonly stale = element('p', { class: 'stale' });
  private readonly facts = element('p', { class: 'facts' });
  private last?: Contact;
  private drawn = -1;
  // False while the tile is scrolled out of sight: then it is not drawn.
  inSight = true;

  constructor(readonly robot: Robot) {
    this.skin = new SkinView(robot);
    this.answers = new AnswersView(robot.stream.started.questions);
    const open = element('a', {
      href: `#robot=${encodeURIComponent(robot.key)}`, class: 'tile-link' },
      robot.name);
    this.root = element('article', { class: 'tile', 'data-robot': robot.name },
      element('header', {}, element('h2', {}, open),
        element('span', { class: 'model' }, modelOf(robot.stream))),
      element('div', { class: 'skin-box' }, this.skin.root, this.stale),
      this.facts, this.answers.root);
  }

  // Draws what is new; true if there was a new frame.
  update(now: number): boolean {
    const stale = stalenessOf(this.robot, now);
    this.root.classList.toggle('is-stale', stale !== '');
    setText(this.stale, stale);
    if (!this.inSight || this.drawn === this.robot.frames) return false;
    this.drawn = this.robot.frames;
    const contacts = this.robot.frame?.answer.contacts ?? [];
    this.skin.draw(this.robot.taxels, contacts);
    const shown = contactOf(this.robot, this.last);
    this.last = shown;
    this.answers.show(shown, contacts.some(isFelt));
    setText(this.facts, factsOf(this.robot));
    return true;
  }
}

// Rate, scale, and what was lost.
export function factsOf(robot: Robot): string {
  const geometry = geometryOf(robot);
  const counts = robot.counts;
  const facts = [`${geometry.rows} x ${geometry.columns}`];
  if (counts !== undefined && counts.measured_rate_hz > 0) {
    facts.push(`${number(counts.measured_rate_hz)} Hz`);
  }
  if (robot.full > 0) {
    facts.push(`0 to ${number(robot.full)} ${unitOf(geometry)}`);
  }
  if (counts !== undefined) {
    facts.push(counts.contacts === '1' ? '1 contact' :
      `${counts.contacts} contacts`);
    if (Number(counts.frames_missing) > 0) {
      facts.push(`${counts.frames_missing} frames lost`);
    }
    if (Number(counts.superseded) > 0) {
      facts.push(`${counts.superseded} answers left out`);
    }
  }
  return facts.join(' · ');
}
