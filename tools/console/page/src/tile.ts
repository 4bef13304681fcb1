// A robot on the live page.

import { AnswersView } from './answers';
import { element } from './dom';
import { FactsView, stalenessOf, StaleView } from './facts';
import { noteDrawn } from './measures';
import { geometryOf, type Robot } from './robots';
import { SkinView } from './skin';
import { isFelt, modelOf, unitOf } from './words';

// Nobody reads numbers that change more often.
const NUMBERS_MS = 100;
const MOST_VALUES = 4;

export class Tile {
  readonly root: HTMLElement;
  readonly link: HTMLAnchorElement;
  // False while it is scrolled out of sight.
  seen = true;
  private readonly skin: SkinView;
  private readonly answers: AnswersView;
  private readonly facts: FactsView;
  private readonly stale = new StaleView();
  private drawn = -1;
  private written = -1;
  private writtenAt = 0;

  constructor(readonly robot: Robot) {
    const { questions } = robot.stream.started;
    this.skin = new SkinView(robot);
    this.answers =
      new AnswersView(questions, unitOf(geometryOf(robot)), MOST_VALUES);
    this.facts = new FactsView(robot);
    this.link = element('a', {
      href: `#robot=${encodeURIComponent(robot.key)}`, class: 'tile-link' },
    robot.name);
    this.root = element('article', { class: 'tile', 'data-robot': robot.name },
      element('header', {}, element('h2', {}, this.link),
        element('p', { class: 'model' }, modelOf(robot.stream))),
      element('div', { class: 'skin-box' }, this.skin.root, this.stale.root),
      this.facts.root, this.answers.root);
  }

  close(): void { this.skin.close(); }

  // Draws what is new.
  update(now: number): void {
    if (!this.seen) return;
    const stale = stalenessOf(this.robot, now);
    this.root.classList.toggle('is-stale', stale !== '');
    this.stale.show(stale);
    const { frame, frames, taxels, last } = this.robot;
    const contacts = frame?.answer.contacts ?? [];
    if (this.drawn !== frames) {
      this.drawn = frames;
      this.skin.draw(taxels, contacts);
      noteDrawn(this.robot);
    }
    if (this.written === frames || now - this.writtenAt < NUMBERS_MS) return;
    this.written = frames;
    this.writtenAt = now;
    const felt = contacts.filter(isFelt);
    this.answers.show(felt[0] ?? last, felt.length > 0, felt.length - 1);
    this.facts.update();
    this.skin.describe();
  }
}
