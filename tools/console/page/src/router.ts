// Router: opens the page that the address names, and shows the way to others.

import { addressOf, hrefOf } from './address';
import { Api } from './api';
import type { Session } from './connection';
import { byId, element, setText } from './dom';
import type { Page, PageKind } from './page';
import { PAGES } from './pages';
import { leaveTold } from './parts/states';

export class Router {
  private page?: Page;
  private kind?: PageKind;
  private api?: Api;

  constructor(private readonly session: Session,
      private readonly onSignedOut: () => void) {
    window.addEventListener('hashchange', this.go);
    byId('server-choice').onchange = () => {
      const { page } = addressOf(location.hash);
      location.hash = hrefOf(page, Number(this.choice.value));
    };
    this.choice.replaceChildren(...session.servers.map((address, i) =>
      element('option', { value: String(i) }, address)));
    this.go();
  }

  close(): void {
    window.removeEventListener('hashchange', this.go);
    this.leave();
    byId('pages').replaceChildren();
    byId('server').hidden = true;
  }

  private get choice(): HTMLSelectElement {
    return byId('server-choice') as HTMLSelectElement;
  }

  private leave(): void {
    this.page?.close();
    this.page = undefined;
    setText(byId('summary'), '');
    byId('notice').hidden = true;
    setText(byId('notice'), '');
    for (const dialog of document.querySelectorAll('dialog')) dialog.close();
  }

  private readonly go = (): void => {
    leaveTold();
    const address = addressOf(location.hash);
    const kind = PAGES.find(({ id }) => id === address.page) ?? PAGES[0]!;
    const { servers } = this.session;
    const server = address.server < servers.length ? address.server : 0;
    if (this.kind !== kind || this.api?.server !== server || !this.page) {
      this.leave();
      const isFirst = this.kind === undefined;
      this.kind = kind;
      if (this.api?.server !== server) {
        this.api = new Api(server, this.session, this.onSignedOut);
      }
      this.showWays(server);
      this.page = kind.open({ main: byId('main'), api: this.api!,
        onSignedOut: this.onSignedOut });
      if (!isFirst) byId('main').focus();
      window.scrollTo(0, 0);
    }
    this.page.show?.(address.path);
    this.keepFocus(kind);
  };

  // What had the focus may be gone. The live page looks after its own.
  private keepFocus({ id }: PageKind): void {
    if (id === '' || document.activeElement !== document.body) return;
    byId('main').focus();
    window.scrollTo(0, 0);
  }

  private showWays(server: number): void {
    byId('server').hidden = !this.kind!.ofOneServer ||
      this.session.servers.length < 2;
    this.choice.value = String(server);
    byId('pages').replaceChildren(...PAGES.map((kind) => {
      const way = element('a', { href: hrefOf(kind.id, server) }, kind.title);
      if (kind === this.kind) way.setAttribute('aria-current', 'page');
      return way;
    }));
    document.title = this.kind!.id === '' ? 'Tactus' :
      `${this.kind!.title} - Tactus`;
  }
}
