// One robot in full: its skin, curves over the last minutes, and events. It can
// be paused and scrubbed, and a taxel can be picked.

import { AnswersView } from './answers';
import { Curves, type Mark } from './curves';
import { element, setText } from './dom';
import { History, largest, lastContact, taxelCount } from './history';
import { geometryOf, loadOf, type Robot } from './robots';
import { SkinView } from './skin';
import { factsOf, stalenessOf } from './tile';
import { eventText, isFelt, modelOf, number, unitOf } from './words';

// Curves are drawn so often; the skin is drawn with each frame.
const CURVES_MS = 200;
const SHOWN_EVENTS = 100;

export class FullView {
  readonly root: HTMLElement;
  private readonly history = new History();
  private readonly skin: SkinView;
  private readonly answers: AnswersView;
  private readonly stale = element('p', { class: 'stale' });
  private readonly facts = element('p', { class: 'facts' });
  private readonly pickText = element('p', { class: 'pick', role: 'status' });
  private readonly events = element('ol', { class: 'events' });
  private readonly slider = element('input', {
    type: 'range', min: '0', max: '0', step: '1',
    'aria-label': 'moment of the last three minutes' });
  private readonly pauseButton = element('button', { type: 'button' }, 'Pause');
  private readonly loads: Curves;
  private readonly areas: Curves;
  private readonly questions: Curves[];
  private readonly observer: ResizeObserver;
  // The moment that is shown; the newest one if undefined.
  private at?: number;
  private drawn = -1;
  private curvesAt = 0;
  private shownEvents = 0;

  constructor(readonly robot: Robot) {
    const { questions } = robot.stream.started;
    const unit = unitOf(geometryOf(robot));
    const pick = (time: number) => this.goTo(time);
    this.skin = new SkinView(robot);
    this.answers = new AnswersView(questions);
    this.loads = new Curves('load', ['force', 'largest taxel', 'picked taxel'],
      unit, undefined, pick);
    this.areas = new Curves('touched', ['taxels'], '', undefined, pick);
    this.questions = questions.map((question) =>
      new Curves(question.name, question.values, 'probability', [0, 1], pick));
    const plots = [this.loads, ...this.questions, this.areas];
    const charts = element('section', { class: 'charts',
      'aria-label': 'curves over time' }, ...plots.map((plot) => plot.root));
    this.root = this.lay(charts);
    this.observer = new ResizeObserver(() => {
      for (const plot of plots) plot.resize(charts.clientWidth);
    });
    this.observer.observe(charts);
    this.listen();
  }

  // Takes the robot's newest frame.
  take(): void { this.history.add(this.robot); }

  update(now: number): void {
    const stale = stalenessOf(this.robot, now);
    this.root.classList.toggle('is-stale', stale !== '');
    setText(this.stale, stale);
    this.showEvents();
    if (this.at !== undefined || this.drawn === this.robot.frames) return;
    this.drawn = this.robot.frames;
    this.draw(now - this.curvesAt > CURVES_MS);
    if (now - this.curvesAt > CURVES_MS) this.curvesAt = now;
  }

  close(): void {
    this.observer.disconnect();
    this.loads.destroy();
    this.areas.destroy();
    for (const plot of this.questions) plot.destroy();
  }

  // True if the key was for this view.
  onKey(event: KeyboardEvent): boolean {
    const inSkin = event.target === this.skin.root;
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === ' ' && !(event.target instanceof HTMLButtonElement)) {
      this.togglePause();
    } else if (inSkin && event.key.startsWith('Arrow')) {
      this.movePick(event.key);
    } else if (step !== undefined && event.target !== this.slider &&
        this.at !== undefined) {
      this.show(this.at + step);
    } else {
      return false;
    }
    event.preventDefault();
    return true;
  }

  private lay(charts: HTMLElement): HTMLElement {
    this.skin.root.tabIndex = 0;
    this.skin.root.setAttribute('role', 'group');
    this.skin.root.setAttribute('aria-label',
      'skin; arrow keys pick a taxel');
    return element('section', { class: 'full', 'data-robot': this.robot.name },
      element('header', { class: 'full-head' },
        element('a', { href: '#', class: 'back' }, '← All robots'),
        element('h1', {}, this.robot.name),
        element('span', { class: 'model' }, modelOf(this.robot.stream))),
      element('div', { class: 'full-grid' },
        element('section', { class: 'full-skin', 'aria-label': 'skin' },
          element('div', { class: 'skin-box' }, this.skin.root, this.stale),
          this.pickText, this.facts,
          element('div', { class: 'scrub' }, this.pauseButton, this.slider),
          this.answers.root),
        charts,
        element('section', { class: 'event-box' },
          element('h2', {}, 'Events'), this.events)));
  }

  private listen(): void {
    this.pauseButton.addEventListener('click', () => this.togglePause());
    this.slider.addEventListener('input', () => {
      this.show(Number(this.slider.value));
    });
    this.skin.root.addEventListener('pointerdown', (event) => {
      const taxel = this.skin.taxelAt(event);
      this.pick(taxel === this.skin.picked ? undefined : taxel);
    });
  }

  private togglePause(): void {
    if (this.at === undefined) {
      this.show(this.history.moments.length - 1);
    } else {
      this.at = undefined;
      setText(this.pauseButton, 'Pause');
      this.draw(true);
    }
  }

  private show(at: number): void {
    const last = this.history.moments.length - 1;
    if (last < 0) return;
    this.at = Math.min(Math.max(at, 0), last);
    setText(this.pauseButton, 'Go on');
    this.draw(true);
  }

  private goTo(time: number): void {
    const times = this.history.times();
    let best = 0;
    times.forEach((t, i) => {
      if (Math.abs(t - time) < Math.abs(times[best]! - time)) best = i;
    });
    this.show(best);
  }

  private pick(taxel: number | undefined): void {
    this.skin.picked = taxel;
    this.draw(true);
  }

  private movePick(key: string): void {
    const { columns } = geometryOf(this.robot);
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns,
      ArrowDown: columns }[key] ?? 0;
    const next = (this.skin.picked ?? -step) + step;
    if (next >= 0 && next < taxelCount(this.robot)) this.pick(next);
  }

  private draw(withCurves: boolean): void {
    const { moments } = this.history;
    const moment = moments[this.at ?? moments.length - 1];
    if (moment === undefined) return;
    this.skin.draw(moment.taxels, moment.contacts);
    const contact = largest(moment) ?? lastContact(this.history, this.robot);
    this.answers.show(contact, moment.contacts.some(isFelt));
    setText(this.facts, factsOf(this.robot));
    this.describePick(moment.taxels);
    this.slider.max = String(moments.length - 1);
    this.slider.value = String(this.at ?? moments.length - 1);
    this.slider.setAttribute('aria-valuetext', `${moment.time.toFixed(2)} s`);
    if (withCurves) {
      this.drawCurves(this.at === undefined ? undefined : moment.time);
    }
  }

  private describePick(taxels: Float32Array): void {
    const taxel = this.skin.picked;
    if (taxel === undefined) {
      return setText(this.pickText, 'Pick a taxel for its value.');
    }
    const { columns } = geometryOf(this.robot);
    const load = loadOf(this.robot, taxels, taxel);
    setText(this.pickText, `taxel ${taxel} (row ${Math.floor(taxel / columns)}, ` +
      `column ${taxel % columns}): ${number(load)} ` +
      unitOf(geometryOf(this.robot)));
  }

  private drawCurves(cursor: number | undefined): void {
    const { history, robot } = this;
    const times = history.times();
    const marks: Mark[] = robot.events
      .map((event) => ({ time: history.timeOf(event.capture_time_ns),
        text: eventText(event, robot.stream) }))
      .filter((mark) => mark.time >= (times[0] ?? 0));
    const { picked } = this.skin;
    this.loads.set(times, [
      history.series((m) => largest(m)?.patch.force ?? 0),
      history.series((m) => largest(m)?.patch.max_force ?? 0),
      history.series((m) =>
        picked === undefined ? null : loadOf(robot, m.taxels, picked)),
    ], marks, cursor);
    this.areas.set(times, [
      history.series((m) => largest(m)?.patch.area_taxels ?? 0)],
    marks, cursor);
    this.questions.forEach((plot, q) => {
      const values = robot.stream.started.questions[q]!.values;
      plot.set(times, values.map((_, v) => history.series((m) =>
        largest(m)?.answers[q]?.probability[v] ?? null)), marks, cursor);
    });
  }

  private showEvents(): void {
    const { events, stream } = this.robot;
    const last = events[events.length - 1];
    const stamp = last ? Number(last.sequence) * 1e3 + events.length : 0;
    if (stamp === this.shownEvents) return;
    this.shownEvents = stamp;
    const lines = events.slice(-SHOWN_EVENTS).reverse().map((event) =>
      element('li', {},
        element('span', { class: 'when' },
          `${this.history.timeOf(event.capture_time_ns).toFixed(2)} s`),
        eventText(event, stream)));
    this.events.replaceChildren(...lines);
  }
}
