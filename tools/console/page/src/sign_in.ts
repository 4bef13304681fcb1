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
  const form = element('form', { class: 'sign-in' },
    element('h1', {}, 'Sign in'),
    element('label', { for: 'token' }, 'Token'), input,
    element('p', { id: 'token-help', class: 'quiet' },
      'The one by which the server knows you. Whoever runs the server makes ' +
      'one with: trainctl tokens create --role=viewer'),
    error, button);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    button.disabled = true;
    setText(error, '');
    void signIn(input.value.trim()).then((answer) => {
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
