// Tells people who listen what changes, in one sentence, not too often.

import { byId, setText } from './dom';

const LEAST_PAUSE_MS = 5000;

export class Announcer {
  private said = '';
  private at = -Infinity;

  say(text: string, now: number): void {
    if (text === this.said || now - this.at < LEAST_PAUSE_MS) return;
    this.said = text;
    this.at = now;
    setText(byId('spoken'), text);
  }
}
