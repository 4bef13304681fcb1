// The form that asks for a token.

import { readSession, signIn, type Session } from './connection';
import { element, setText } from './dom';

// Calls `done` when somebody has signed in.
export function signInForm(message: string,
    done: (session: Session) => void): HTMLElement {
  const error = element('p', { class: 'error', role: 'alert' }, message);
  const input = element('input', {
    type: 'password', id: 'token', autocomplete: 'current-password',
    required: '', 'aria-describedby': 'token-help' });
  const button = element('button', { type: 'submit' }, 'Sign in');
  const form = element('form', { class: 'sign-in card' },
    element('h1', {}, 'Sign in'),
    error,
    element('label', { for: 'token' }, 'Token'), input, button,
    element('div', { id: 'token-help', class: 'quiet' },
      element('p', {}, 'The server knows you by a token. Whoever runs the ' +
        'server makes one that may watch, with'),
      element('pre', {}, 'trainctl tokens create --name=YOU \\\n' +
        '  --role=viewer --file=tokens')));
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    button.disabled = true;
    setText(error, '');
    signIn(input.value.trim()).then((answer) => {
      button.disabled = false;
      if (typeof answer !== 'string') return done(answer);
      setText(error, answer);
      input.select();
    }).catch(() => {
      button.disabled = false;
      setText(error, 'The console does not answer.');
    });
  });
  return form;
}

// Reads the session until the console answers.
export async function awaitSession(onError: () => void): Promise<Session> {
  for (;;) {
    try {
      return await readSession();
    } catch {
      onError();
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
  }
}
