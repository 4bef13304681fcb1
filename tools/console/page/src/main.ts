// The console's page: signs in, then shows what robots feel.

import { signOut, type Session } from './connection';
import { byId } from './dom';
import { LivePage } from './live_page';
import { awaitSession, signInForm } from './sign_in';

declare global {
  interface Window {
    // For tests: how long frames took from the server to the screen.
    tactus: { delays: number[]; framesDrawn: number; messages: number };
  }
}

window.tactus = { delays: [], framesDrawn: 0, messages: 0 };

function notify(text: string): void {
  byId('notice').hidden = text === '';
  byId('notice').textContent = text;
}

function showSignIn(message: string): void {
  byId('sign-out').hidden = true;
  byId('summary').textContent = '';
  notify('');
  byId('main').replaceChildren(signInForm(message, showLive));
  document.getElementById('token')!.focus();
}

function showLive(session: Session): void {
  const page = new LivePage(byId('main'), (reason) => {
    page.close();
    void start(reason);
  });
  const button = byId('sign-out') as HTMLButtonElement;
  button.hidden = !session.needs_token;
  button.onclick = () => {
    page.close();
    void signOut(session.csrf).then(() => showSignIn(''));
  };
}

async function start(reason = ''): Promise<void> {
  const session = await awaitSession(() =>
    notify('The console does not answer. Trying again ...'));
  notify('');
  if (session.signed_in) showLive(session);
  else showSignIn(reason);
}

void start();
