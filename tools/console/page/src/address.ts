// Addresses of pages: "#data@1/arm/3" is the page "data" of server 1 with the
// path ["arm", "3"]. Without a number it is server 0. The live page has the
// empty name, and what follows the # is its own affair.

export interface Address {
  page: string;
  server: number;
  path: string[];
}

const FORM = /^#([a-z]+)(?:@(\d{1,2}))?(?:\/(.*))?$/;

export function addressOf(hash: string): Address {
  const match = FORM.exec(hash);
  if (!match) return { page: '', server: 0, path: [] };
  const path = (match[3] ?? '').split('/').filter((part) => part !== '');
  return { page: match[1]!, server: Number(match[2] ?? 0),
    path: path.map(decode) };
}

export function hrefOf(page: string, server: number, ...path: string[]):
    string {
  const at = server > 0 && page !== '' ? `@${server}` : '';
  return ['#' + page + at, ...path.map(encodeURIComponent)].join('/');
}

function decode(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
