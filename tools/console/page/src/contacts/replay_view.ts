// A contact's frames in motion, with what was answered at each moment.

import { AnswersView } from '../answers';
import { Chart, type Mark } from '../curves';
import { element } from '../dom';
import { EventList } from '../event_list';
import { FactsView } from '../facts';
import { timeOf } from '../robots';
import { SkinView } from '../skin';
import { eventSign, isFelt, percent, quantity, unitOf } from '../words';
import { Player } from './player';
import type { Replay } from './replay';

const MOST_VALUES = 6;
const MOST_CURVES = 5;

export class ReplayView {
  readonly stage: HTMLElement;
  readonly curves: HTMLElement;
  readonly player: Player;
  private readonly skin: SkinView;
  private readonly answers: AnswersView;
  private readonly charts: [Chart, (number | null)[][]][];
  private readonly marks: Mark[];
  private readonly times: number[];
  private readonly observer: ResizeObserver;
  private readonly dark = matchMedia('(prefers-color-scheme: dark)');

  constructor(private readonly replay: Replay) {
    const { robot, times } = replay;
    const { questions, geometry } = robot.stream.started;
    this.times = times;
    this.skin = new SkinView(robot);
    this.answers = new AnswersView(questions, unitOf(geometry), MOST_VALUES);
    const facts = new FactsView(robot);
    facts.update();
    this.player = new Player(times, replay.strongest, (at) => this.draw(at));
    const goTo = (time: number) => this.player.goTo(replay.at(time));
    const chart = (title: string, names: string[], text: (v: number) => string,
        range?: [number, number]) =>
      new Chart({ title, names, text, range, onTime: goTo });
    this.charts = [
      ...questions.map(({ name, values }, q): [Chart, (number | null)[][]] => [
        chart(name, values.slice(0, MOST_CURVES), percent, [0, 1]),
        replay.answers(q).slice(0, MOST_CURVES)]),
      [chart('Force', ['this contact'], (value) =>
        quantity(value, unitOf(geometry))), [replay.force]],
    ];
    this.marks = robot.events.map((event) =>
      ({ time: timeOf(robot, event.capture_time_ns), sign: eventSign(event) }));
    const events = new EventList(robot, goTo);
    events.update();
    const box = element('div', { class: 'skin-box' }, this.skin.root);
    box.style.aspectRatio = String(Math.max(this.skin.aspect, 1));
    this.stage = element('div', { class: 'replay-stage' },
      element('div', { class: 'replay-skin' }, box, facts.root,
        this.player.root), this.answers.root);
    const charts = element('div', { class: 'charts' },
      ...this.charts.map(([made]) => made.root));
    events.root.classList.remove('card');
    this.curves = element('div', { class: 'replay-curves' }, charts,
      events.root);
    this.observer = new ResizeObserver(() => {
      for (const [made] of this.charts) made.resize(charts.clientWidth);
    });
    this.observer.observe(charts);
    this.dark.addEventListener('change', this.redraw);
    this.draw(this.player.at);
  }

  close(): void {
    this.player.stop();
    this.skin.close();
    this.observer.disconnect();
    this.dark.removeEventListener('change', this.redraw);
    for (const [chart] of this.charts) chart.close();
  }

  private readonly redraw = (): void => {
    for (const [chart] of this.charts) chart.redraw();
  };

  private draw(at: number): void {
    const moment = this.replay.moments[at];
    if (moment === undefined) return;
    this.skin.draw(moment.taxels, moment.contacts);
    this.skin.describe();
    const { shown } = moment;
    const felt = moment.contacts.filter(isFelt);
    const isThis = shown !== undefined && isFelt(shown);
    this.answers.show(shown ?? this.lastBefore(at), isThis,
      felt.length - Number(isThis));
    const from = this.times[0]!;
    const window = { from, to: Math.max(this.times[this.times.length - 1]!,
      from + 0.1), marks: this.marks, cursor: moment.time };
    for (const [chart, series] of this.charts) {
      chart.set(window, this.times, series,
        series.map((values) => values[at] ?? null));
    }
  }

  private lastBefore(at: number) {
    const { moments } = this.replay;
    for (let i = at; i >= 0; --i) {
      if (moments[i]!.shown) return moments[i]!.shown;
    }
    return undefined;
  }
}
