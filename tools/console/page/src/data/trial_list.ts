// TrialList: the trials of one version, of one label or of all, as far as they
// were asked for. A text is looked for here, because servers look for whole
// labels alone.

import type { Api } from '../api';
import type { Trial } from '../wire';

const PAGE = 500;

export class TrialList {
  readonly trials: Trial[] = [];
  private token = '';
  private isOver = false;

  constructor(private readonly api: Api, private readonly version: string,
      private readonly label: string) {}

  // Trials `first` to `first` + `count` of those that hold `text`, and whether
  // there are more.
  async slice(text: string, first: number, count: number,
      signal: AbortSignal): Promise<{ trials: Trial[]; more: boolean }> {
    const needle = text.trim().toLowerCase();
    const matches = () => needle === '' ? this.trials :
      this.trials.filter((trial) => holds(trial, needle));
    while (!this.isOver && matches().length <= first + count) {
      await this.readOn(signal);
    }
    const found = matches();
    return { trials: found.slice(first, first + count),
      more: found.length > first + count };
  }

  private async readOn(signal: AbortSignal): Promise<void> {
    const { trials, next_page_token } = await this.api.call<{ trials: Trial[];
      next_page_token: string; }>('TrainingService/ListTrials', {
      dataset_version: this.version, page_size: PAGE, page_token: this.token,
      label: this.label }, signal);
    // Another load may have read the same page.
    if (signal.aborted) return;
    this.trials.push(...trials);
    this.token = next_page_token;
    this.isOver = next_page_token === '';
  }
}

function holds(trial: Trial, needle: string): boolean {
  return [trial.id, trial.label, trial.condition, trial.object, trial.material,
    trial.source].some((text) => text.toLowerCase().includes(needle));
}
