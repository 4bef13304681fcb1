// The console's page: signs in, then shows what the address names.

import { signOut, type Session } from './connection';
import { byId, setText } from './dom';
import { Router } from './router';
import { awaitSession, signInForm } from './sign_in';

const SIGNED_OUT = 'The sign-in is no longer valid. Please sign in again.';

function notify(text: string): void {
  byId('notice').hidden = text === '';
  setText(byId('notice'), text);
}

function showSignIn(message: string): void {
  byId('person').hidden = true;
  setText(byId('summary'), '');
  notify('');
  byId('main').replaceChildren(signInForm(message, showPages));
  byId('token').focus();
}

function showPages(session: Session): void {
  let over = false;
  const router = new Router(session, () => {
    if (over) return;
    over = true;
    router.close();
    void start(SIGNED_OUT);
  });
  byId('person').hidden = session.needs_token === false;
  setText(byId('name'), session.name ?? '');
  byId('sign-out').onclick = () => {
    over = true;
    router.close();
    const done = () => showSignIn('');
    signOut(session.csrf).then(done, done);
  };
}

async function start(reason = ''): Promise<void> {
  const session = await awaitSession(() =>
    notify('The console does not answer. Trying again ...'));
  notify('');
  if (session.signed_in) showPages(session);
  else showSignIn(reason);
}

void start();
