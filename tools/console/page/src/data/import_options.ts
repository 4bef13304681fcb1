// What an import is told beside its files, as the flags of trainctl import.
// Only what the files leave open is asked.

import { element } from '../dom';
import type { PickedFile } from './picked_files';

// A select with more is of no use.
const MOST_CHOICES = 200;

let optionIds = 0;

type Input = HTMLInputElement | HTMLSelectElement;

export class ImportOptions {
  readonly root = element('div', { class: 'import-options' });
  private readonly source = element('select');
  private readonly skin = element('select');
  private readonly table = element('select');
  private readonly pattern = textInput('{label}_{group}.csv');
  private readonly label = textInput();
  private readonly condition = textInput();
  private readonly fields: Record<string, HTMLElement>;

  constructor(private readonly onChange: () => void) {
    this.fields = {
      source: fieldOf('Read', this.source),
      skin: fieldOf('Skin', this.skin),
      table: fieldOf('Table', this.table),
      pattern: fieldOf('Names of files say', this.pattern,
        'Which parts of a name are label, condition or group.'),
      label: fieldOf('Label', this.label, 'Of trials that have none.'),
      condition: fieldOf('Condition', this.condition,
        'Of trials that have none.'),
    };
    this.root.append(...Object.values(this.fields));
    this.source.addEventListener('change', () => this.onSource());
    for (const input of [this.skin, this.table]) {
      input.addEventListener('change', onChange);
    }
    for (const input of [this.pattern, this.label, this.condition]) {
      input.addEventListener('input', onChange);
    }
  }

  // Offers what there is among the files.
  show(files: PickedFile[]): void {
    const names = files.map(({ name }) => name);
    // What lies deeper is named by a table.
    const ending = (...endings: string[]) => names.filter((name) =>
      !name.includes('/') && endings.some((end) => name.endsWith(end)))
      .slice(0, MOST_CHOICES);
    const whole: [string, string] = ['', 'all files together, as a folder'];
    const alone = ending('.h5', '.mcap', '.csv', '.npz').map(
      (name): [string, string] => [name, name]);
    fill(this.source, names.length > 1 ? [whole, ...alone] : alone.length > 0 ?
      alone : [whole], likeliestSource(names));
    fill(this.skin, [['', ''], ...ending('.json').map(
      (name): [string, string] => [name, name])], '');
    fill(this.table, [['', ''], ...ending('.csv').map(
      (name): [string, string] => [name, name])], '');
    this.proposeHelpers(names);
    this.showFields();
  }

  disable(disabled: boolean): void {
    for (const input of this.root.querySelectorAll<Input>('input, select')) {
      input.disabled = disabled;
    }
  }

  // As the console takes it.
  values(): Record<string, string> {
    const all = { source: this.source.value, skin: this.skin.value,
      table: this.table.value, file_names: this.pattern.value,
      label: this.label.value.trim(), condition: this.condition.value.trim() };
    return Object.fromEntries(Object.entries(all).filter(([, value]) =>
      value !== ''));
  }

  private get isFolder(): boolean { return this.source.value === ''; }

  private onSource(): void {
    this.skin.value = this.table.value = '';
    this.showFields();
    this.onChange();
  }

  // The one skin of another name, and the table of a recording.
  private proposeHelpers(names: string[]): void {
    const only = (end: string) => {
      const all = names.filter((name) => name.endsWith(end));
      return all.length === 1 ? all[0]! : '';
    };
    const source = this.source.value;
    if (this.skin.value === '' && !(this.isFolder &&
      names.includes('skin.json')) && /^$|\.(h5|mcap)$/.test(source)) {
      this.skin.value = only('.json');
    }
    if (this.table.value === '' && source.endsWith('.mcap')) {
      this.table.value = only('.csv');
    }
  }

  private showFields(): void {
    const source = this.source.value;
    this.skin.options[0]!.text = this.isFolder ? 'the skin.json of the folder' :
      'that of the file';
    this.table.options[0]!.text = this.isFolder ? 'as the skin.json says' :
      'none';
    this.fields.source!.hidden = this.source.options.length < 2;
    this.fields.skin!.hidden = this.skin.options.length < 2 ||
      !/^$|\.(h5|mcap)$/.test(source);
    // Signals need neither.
    const isSkinFolder = this.isFolder && this.skin.options.length > 1;
    this.fields.table!.hidden = this.table.options.length < 2 ||
      !(isSkinFolder || source.endsWith('.mcap'));
    this.fields.pattern!.hidden = !isSkinFolder;
    for (const [name, input] of [['skin', this.skin], ['table', this.table],
      ['pattern', this.pattern]] as const) {
      if (this.fields[name]!.hidden) input.value = '';
    }
  }
}

// One trial file or recording is what an import is of; anything else belongs
// together.
function likeliestSource(names: string[]): string {
  const main = names.filter((name) => /\.(h5|mcap)$/.test(name));
  const others = names.filter((name) => !main.includes(name));
  const isHelper = (name: string) => name.endsWith('.json') ||
    (main[0]!.endsWith('.mcap') && name.endsWith('.csv'));
  if (main.length === 1 && others.every(isHelper)) return main[0]!;
  return names.length === 1 ? names[0]! : '';
}

// What was chosen stays, if it is still there.
function fill(select: HTMLSelectElement, options: [string, string][],
    otherwise: string): void {
  const { value } = select;
  const wasChosen = select.options.length > 0 && value !== '';
  select.replaceChildren(...options.map(([name, text]) =>
    element('option', { value: name }, text)));
  const isThere = options.some(([name]) => name === value);
  select.value = wasChosen && isThere ? value : otherwise;
}

function textInput(placeholder = ''): HTMLInputElement {
  return element('input', { type: 'text', autocomplete: 'off', maxlength: '256',
    ...(placeholder ? { placeholder } : {}) });
}

function fieldOf(label: string, input: Input, hint = ''): HTMLElement {
  input.id = `import-${++optionIds}`;
  const parts: HTMLElement[] = [
    element('label', { for: input.id }, label), input];
  if (hint) {
    input.setAttribute('aria-describedby', `${input.id}-hint`);
    parts.push(element('p', { class: 'hint', id: `${input.id}-hint` }, hint));
  }
  return element('div', { class: 'field' }, ...parts);
}
