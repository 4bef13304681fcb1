// The controls of a replay: play, the moment that is shown, and its time.

import { element, setAttribute, setText } from '../dom';
import { clock } from '../words';

export class Player {
  readonly root: HTMLElement;
  private readonly button = element('button', { type: 'button',
    class: 'pause', 'aria-keyshortcuts': 'Space' }, 'Play');
  private readonly slider = element('input', { type: 'range', min: '0',
    step: '1', 'aria-label': 'Moment of the contact' });
  private readonly time = element('output', { class: 'time' });
  private animation = 0;
  private index: number;

  // `onMoment` is called with the index of the moment to show.
  constructor(private readonly times: number[], first: number,
      private readonly onMoment: (index: number) => void) {
    this.index = first;
    this.slider.max = String(Math.max(0, times.length - 1));
    this.button.addEventListener('click', () => this.toggle());
    this.slider.addEventListener('input', () =>
      this.goTo(Number(this.slider.value)));
    this.root = element('div', { class: 'transport' }, this.button,
      this.slider, this.time);
    this.show();
  }

  get at(): number { return this.index; }

  toggle(): void {
    if (this.animation !== 0) return this.stop();
    const { times } = this;
    if (times.length === 0) return;
    if (this.index === times.length - 1) this.set(0);
    let before = performance.now();
    let time = times[this.index]!;
    const step = (now: number) => {
      time += (now - before) / 1000;
      before = now;
      let next = this.index;
      while (next + 1 < times.length && times[next + 1]! <= time) ++next;
      if (next !== this.index) this.set(next);
      if (next === times.length - 1) return this.stop();
      this.animation = requestAnimationFrame(step);
    };
    this.animation = requestAnimationFrame(step);
    setText(this.button, 'Pause');
  }

  // Goes by so many frames.
  step(by: number): void { this.goTo(this.index + by); }

  goTo(index: number): void {
    this.stop();
    this.set(Math.min(Math.max(index, 0), this.times.length - 1));
  }

  stop(): void {
    cancelAnimationFrame(this.animation);
    this.animation = 0;
    setText(this.button, 'Play');
  }

  private set(index: number): void {
    this.index = index;
    this.show();
    this.onMoment(index);
  }

  private show(): void {
    const text = clock(this.times[this.index] ?? 0);
    this.slider.value = String(this.index);
    setAttribute(this.slider, 'aria-valuetext', text);
    setText(this.time, text);
  }
}
