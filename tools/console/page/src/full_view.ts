// One robot in full: its skin, curves over the last minutes, and events. It can
// be paused and scrubbed, and a taxel can be picked.

import { AnswersView } from './answers';
import { Charts } from './charts';
import { ContactChoice } from './contact_choice';
import { element, setText } from './dom';
import { EventList } from './event_list';
import { FactsView, stalenessOf, StaleView } from './facts';
import type { History, Moment } from './history';
import { noteDrawn } from './measures';
import { geometryOf, loadOf, type Robot } from './robots';
import { SkinView } from './skin';
import { Transport } from './transport';
import { isFelt, modelOf, quantity, unitOf } from './words';

// Curves and numbers change so often; the skin with each frame.
const CURVES_MS = 200;
const NUMBERS_MS = 100;
const MOST_VALUES = 12;

export class FullView {
  readonly root: HTMLElement;
  private readonly skin: SkinView;
  private readonly answers: AnswersView;
  private readonly choice = new ContactChoice(() => this.draw());
  private readonly facts: FactsView;
  private readonly stale = new StaleView();
  private readonly pickText = element('p', { class: 'pick' });
  private readonly transport: Transport;
  private readonly charts: Charts;
  private readonly events: EventList;
  // The moment that is shown; the newest one if undefined.
  private at?: number;
  private drawn = -1;
  private numbersAt = 0;
  private curvesAt = 0;

  constructor(readonly robot: Robot, private readonly history: History) {
    const goTo = (time: number) => this.show(this.history.nearest(time));
    history.setViewed(true);
    this.skin = new SkinView(robot);
    this.answers = new AnswersView(robot.stream.started.questions,
      unitOf(geometryOf(robot)), MOST_VALUES);
    this.facts = new FactsView(robot);
    this.transport = new Transport(() => this.togglePause(),
      (index) => this.show(index), () => this.draw());
    this.charts = new Charts(robot, history, goTo);
    this.events = new EventList(robot, goTo);
    this.root = this.lay();
    this.skin.root.addEventListener('pointerdown', (event) => {
      const taxel = this.skin.taxelAt(event);
      this.pick(taxel === this.skin.picked ? undefined : taxel);
    });
  }

  get isPaused(): boolean { return this.at !== undefined; }

  update(now: number): void {
    const stale = stalenessOf(this.robot, now);
    this.root.classList.toggle('is-stale', stale !== '');
    this.stale.show(stale);
    this.events.update();
    if (this.drawn === this.robot.frames) return;
    if (this.at !== undefined) {
      // The window of the slider moves on.
      this.drawn = this.robot.frames;
      return this.show(this.at);
    }
    const moment = this.history.at(this.history.end - 1);
    if (moment === undefined) return;
    this.drawn = this.robot.frames;
    this.skin.draw(moment.taxels, moment.contacts);
    noteDrawn(this.robot);
    if (now - this.numbersAt > NUMBERS_MS) {
      this.numbersAt = now;
      this.drawNumbers(moment);
    }
    if (now - this.curvesAt > CURVES_MS) {
      this.curvesAt = now;
      this.drawCurves();
    }
  }

  close(): void {
    this.history.setViewed(false);
    this.skin.close();
    this.charts.close();
  }

  // A key for this view: space pauses, arrows go through frames or taxels.
  onKey(event: KeyboardEvent): void {
    const { target, key } = event;
    const inSkin = target === this.skin.root;
    const step = { ArrowLeft: -1, ArrowRight: 1 }[key];
    if (key === ' ' && !(target instanceof HTMLButtonElement)) {
      this.togglePause();
    } else if (inSkin && key.startsWith('Arrow')) {
      this.movePick(key);
    } else if (step !== undefined && target !== this.transport.slider &&
        this.at !== undefined) {
      this.show(this.at + step);
    } else {
      return;
    }
    event.preventDefault();
  }

  private lay(): HTMLElement {
    const { root } = this.skin;
    root.tabIndex = 0;
    root.setAttribute('role', 'group');
    root.setAttribute('aria-label', 'Skin; arrow keys pick a taxel');
    // Nothing is beside it that must be as high.
    const box = element('div', { class: 'skin-box' }, root, this.stale.root);
    box.style.aspectRatio = String(Math.max(this.skin.aspect, 1));
    return element('div', { class: 'full', 'data-robot': this.robot.name },
      element('header', { class: 'full-head' },
        element('a', { href: '#', class: 'back' }, '← All robots'),
        element('h1', {}, this.robot.name),
        element('p', { class: 'model' }, modelOf(this.robot.stream))),
      element('div', { class: 'full-grid' },
        element('section', { class: 'full-skin card' },
          element('h2', { class: 'unseen' }, 'Skin and answers'),
          box, this.facts.root, this.pickText, this.transport.root,
          this.choice.root, this.answers.root),
        this.charts.root, this.events.root));
  }

  private togglePause(): void {
    if (this.at === undefined) {
      this.show(this.history.end - 1);
    } else {
      this.at = undefined;
      this.draw();
    }
  }

  private show(at: number): void {
    if (this.history.moments.length === 0) return;
    this.at = Math.min(Math.max(at, this.history.first), this.history.end - 1);
    this.draw();
  }

  private pick(taxel: number | undefined): void {
    this.skin.picked = taxel;
    this.draw();
  }

  private movePick(key: string): void {
    const { rows, columns } = geometryOf(this.robot);
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns,
      ArrowDown: columns }[key] ?? 0;
    const picked = this.skin.picked;
    const next = picked === undefined ? 0 : picked + step;
    if (next >= 0 && next < rows * columns) this.pick(next);
  }

  private get moment(): Moment | undefined {
    return this.history.at(this.at ?? this.history.end - 1);
  }

  // Draws all at once, after something was done.
  private draw(): void {
    const { moment } = this;
    if (moment === undefined) return;
    this.skin.draw(moment.taxels, moment.contacts);
    this.drawNumbers(moment);
    this.drawCurves();
  }

  private drawNumbers(moment: Moment): void {
    const felt = moment.contacts.filter(isFelt);
    const shown = this.choice.of(felt) ?? this.lastContact();
    this.answers.show(shown, felt.length > 0, felt.length - 1);
    this.facts.update();
    this.skin.describe();
    setText(this.pickText, this.pickWords(moment.taxels));
    const { first, end } = this.history;
    this.transport.show(first, end, this.at ?? end - 1, moment.time,
      this.isPaused);
  }

  // The last one that was felt at or before the moment that is shown.
  private lastContact() {
    if (this.at === undefined) return this.robot.last;
    for (let i = this.at; i >= this.history.first; --i) {
      const contact = this.history.at(i)!.contacts.find(isFelt);
      if (contact !== undefined) return contact;
    }
    return undefined;
  }

  private drawCurves(): void {
    this.charts.draw(this.transport.span, this.at ?? this.history.end - 1,
      this.isPaused, this.skin.picked);
  }

  private pickWords(taxels: Float32Array): string {
    const taxel = this.skin.picked;
    if (taxel === undefined) return 'Pick a taxel to see its load.';
    const { columns } = geometryOf(this.robot);
    const load = loadOf(this.robot, taxels, taxel);
    return `taxel ${taxel} (row ${Math.floor(taxel / columns)}, ` +
      `column ${taxel % columns}): ` +
      quantity(load, unitOf(geometryOf(this.robot)));
  }
}
