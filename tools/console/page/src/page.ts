// What a page is to the others: something that is opened on the main part of
// the document, follows the address, and is closed.

import type { Api } from './api';

export interface PageContext {
  main: HTMLElement;
  // The server that the address names.
  api: Api;
  // What to do when the sign-in is over.
  onSignedOut: () => void;
}

export interface Page {
  // Shows what a path below the page names; called after it is opened, and when
  // the address changes within the page.
  show?(path: string[]): void;
  close(): void;
}

export interface PageKind {
  // As in addresses; empty for the live page.
  id: string;
  title: string;
  // Shows one server, which can be chosen if there are several.
  ofOneServer: boolean;
  open(context: PageContext): Page;
}
