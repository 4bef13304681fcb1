// The pages, in the order of the navigation. A page is one file, and a line
// here. The first one is shown if the address names none.

import { LIVE } from './live_page';
import { CONTACTS } from './contacts/contacts_page';
import { DATA } from './data/data_page';
import type { PageKind } from './page';
import { SERVER } from './server/server_page';
import { TRAIN } from './train/train_page';

export const PAGES: PageKind[] = [
  LIVE,
  CONTACTS,
  DATA,
  TRAIN,
  SERVER,
];
