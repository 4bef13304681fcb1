// Which contacts the log still has. It drops the oldest first, so that all
// before one that is gone are gone, too.

import { ApiError, type Api } from '../api';
import type { ContactList, Logged } from './messages';

const MOST_NAMES = 200;

export async function lookAgain(api: Api, names: string[]): Promise<Logged[]> {
  const newestFirst = [...names].sort((a, b) => recordOf(b) - recordOf(a));
  const found: Logged[] = [];
  for (let i = 0; i < newestFirst.length; i += MOST_NAMES) {
    const some = newestFirst.slice(i, i + MOST_NAMES);
    try {
      found.push(...await listNamed(api, some));
    } catch (error) {
      if (!(error instanceof ApiError) ||
          error.reason !== 'CONTACT_NOT_FOUND') {
        throw error;
      }
      const gone = recordOf(error.metadata.contact ?? '');
      const left = some.filter((name) => recordOf(name) > gone);
      if (left.length > 0) found.push(...await listNamed(api, left));
      break;
    }
  }
  return found;
}

async function listNamed(api: Api, names: string[]): Promise<Logged[]> {
  return (await api.call<ContactList>('ContactLogService/ListContacts',
    { names, page_size: MOST_NAMES })).contacts;
}

// "contacts/17-2" is in the record 17.
function recordOf(name: string): number {
  return Number(/^contacts\/(\d+)/.exec(name)?.[1] ?? 0);
}
