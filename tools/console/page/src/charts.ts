// The charts of a robot: force, loads, touched taxels, and the answers to each
// question.

import { Chart, type Mark, type Window } from './curves';
import { element } from './dom';
import type { History, Series } from './history';
import { geometryOf, timeOf, type Robot } from './robots';
import { eventSign, percent, quantity, unitOf } from './words';

// A question with more values shows the curves of the most probable.
const MOST_CURVES = 5;

export class Charts {
  readonly root: HTMLElement;
  private readonly force: Chart;
  private readonly loads: Chart;
  private readonly area: Chart;
  private readonly answers: Chart[];
  private readonly observer: ResizeObserver;
  private readonly dark = matchMedia('(prefers-color-scheme: dark)');

  constructor(private readonly robot: Robot, private readonly history: History,
      onTime: (time: number) => void) {
    const unit = unitOf(geometryOf(robot));
    const text = (value: number) => quantity(value, unit);
    // A taxel is loaded much less than all together.
    this.force = new Chart({ title: 'Force',
      names: ['largest contact'], text, onTime });
    this.loads = new Chart({ title: 'Taxel load',
      names: ['largest', 'picked'], text, onTime });
    this.area = new Chart({ title: 'Touched taxels',
      names: ['largest contact'], text: String, onTime });
    this.answers = robot.stream.started.questions.map((question) =>
      new Chart({ title: question.name, range: [0, 1], text: percent, onTime,
        names: question.values.slice(0, MOST_CURVES) }));
    this.root = element('section', { class: 'charts card' },
      element('h2', {}, 'Curves'), ...this.all.map((chart) => chart.root));
    this.observer = new ResizeObserver(() => {
      for (const chart of this.all) chart.resize(chart.root.clientWidth);
    });
    this.observer.observe(this.root);
    this.dark.addEventListener('change', this.redraw);
  }

  // Shows `span` seconds that end now, or around a moment that is shown.
  draw(span: number, at: number, paused: boolean, picked?: number): void {
    const { history } = this;
    const moment = history.at(at);
    if (moment === undefined) return;
    const window = this.windowOf(span, moment.time, paused);
    const from = Math.max(history.lowerBound(window.from) - 1, 0);
    const to = history.lowerBound(window.to) + 1;
    const times = history.times.slice(from, to);
    const show = (chart: Chart, all: Series[]) => chart.set(window, times,
      all.map((series) => series.slice(from, to)),
      all.map((series) => series[at - history.first] ?? null));
    const loads = picked === undefined ? [] :
      history.loads(picked, 0, history.times.length);
    show(this.force, [history.force]);
    show(this.loads, [history.largest, loads]);
    show(this.area, [history.area]);
    this.answers.forEach((chart, q) =>
      show(chart, history.answers[q]!.slice(0, MOST_CURVES)));
  }

  close(): void {
    this.observer.disconnect();
    this.dark.removeEventListener('change', this.redraw);
    for (const chart of this.all) chart.close();
  }

  private get all(): Chart[] {
    return [this.force, this.loads, ...this.answers, this.area];
  }

  private readonly redraw = (): void => {
    for (const chart of this.all) chart.redraw();
  };

  private windowOf(span: number, time: number, paused: boolean): Window {
    const { times } = this.history;
    const last = times[times.length - 1]!;
    // Once the moment is left of the newest window, it is in the middle. No
    // window begins before the stream.
    const end = paused && time < last - span ? time + span / 2 : last;
    const from = Math.max(end - span, Math.min(times[0]!, 0));
    const to = from + span;
    const marks: Mark[] = this.robot.events
      .map((event) => ({ time: timeOf(this.robot, event.capture_time_ns),
        sign: eventSign(event) }))
      .filter((mark) => mark.time >= from && mark.time <= to);
    return { from, to, marks, cursor: paused ? time : undefined };
  }
}
