// A question with fields in a dialog, which stays open until its work is done
// and shows why it is not.

import { element, setText } from '../dom';
import { textOf } from './states';

export interface Field {
  name: string;
  label: string;
  // A text by default; "select" needs `options`.
  type?: 'text' | 'number' | 'select' | 'check';
  value?: string;
  options?: [string, string][];
  // Suggestions for a text.
  list?: string[];
  hint?: string;
  required?: boolean;
  // Of numbers.
  min?: string;
  max?: string;
  step?: string;
  // The text that has to be typed.
  typed?: string;
}

export interface Question {
  title: string;
  text?: string;
  fields: Field[];
  action: string;
  danger?: boolean;
  // Throws if it does not work.
  run: (values: Record<string, string>) => Promise<void>;
}

type Input = HTMLInputElement | HTMLSelectElement;
let fieldIds = 0;

export function ask(question: Question): void {
  const inputs = new Map<string, Input>();
  const error = element('p', { class: 'error', role: 'alert' });
  const submit = element('button', { type: 'submit',
    class: question.danger ? 'danger' : 'main' }, question.action);
  const cancel = element('button', { type: 'button' }, 'Cancel');
  const form = element('form', { class: 'fields', method: 'dialog' },
    element('h2', { id: 'dialog-title' }, question.title),
    ...(question.text ? [element('p', {}, question.text)] : []),
    ...question.fields.map((field) => fieldOf(field, inputs)), error,
    element('div', { class: 'buttons' }, submit, cancel));
  const dialog = element('dialog', { 'aria-labelledby': 'dialog-title' }, form);
  const check = () => {
    submit.disabled = question.fields.some(({ name, typed }) =>
      typed !== undefined && inputs.get(name)!.value !== typed);
  };
  form.addEventListener('input', check);
  cancel.addEventListener('click', () => dialog.close());
  dialog.addEventListener('close', () => dialog.remove());
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    submit.disabled = true;
    setText(error, '');
    question.run(valuesOf(inputs)).then(() => dialog.close(), (failure) => {
      setText(error, textOf(failure));
      check();
    });
  });
  document.body.append(dialog);
  check();
  dialog.showModal();
}

function valuesOf(inputs: Map<string, Input>): Record<string, string> {
  const values: Record<string, string> = {};
  for (const [name, input] of inputs) {
    const box = input instanceof HTMLInputElement && input.type === 'checkbox';
    values[name] = box ? (input.checked ? 'yes' : '') : input.value;
  }
  return values;
}

function fieldOf(field: Field, inputs: Map<string, Input>): HTMLElement {
  const id = `field-${++fieldIds}`;
  const input = inputOf(field, id);
  inputs.set(field.name, input);
  const label = element('label', { for: id }, field.label);
  if (field.type === 'check') {
    return element('div', { class: 'check' }, input, label);
  }
  const parts: HTMLElement[] = [label, input];
  if (field.list) {
    input.setAttribute('list', `${id}-list`);
    parts.push(element('datalist', { id: `${id}-list` }, ...field.list.map(
      (value) => element('option', { value }))));
  }
  if (field.hint) {
    input.setAttribute('aria-describedby', `${id}-hint`);
    parts.push(element('p', { class: 'hint', id: `${id}-hint` }, field.hint));
  }
  return element('div', { class: 'field' }, ...parts);
}

function inputOf(field: Field, id: string): Input {
  const required: Record<string, string> =
    field.required ? { required: '' } : {};
  if (field.type === 'select') {
    const select = element('select', { id, ...required },
      ...field.options!.map(([value, text]) =>
        element('option', { value }, text)));
    if (field.value !== undefined) select.value = field.value;
    return select;
  }
  const bounds: Record<string, string> = {};
  for (const name of ['min', 'max', 'step'] as const) {
    if (field[name] !== undefined) bounds[name] = field[name];
  }
  const type = field.type === 'check' ? 'checkbox' : field.type ?? 'text';
  const input = element('input',
    { id, type, autocomplete: 'off', ...required, ...bounds });
  if (type !== 'checkbox') input.value = field.value ?? '';
  return input;
}
