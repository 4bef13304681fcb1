// Attacks a console until it is ended: every case of hostile.mjs, by turns.
//
//   node siege.mjs ADDRESS

import { hostileCases, randomOf } from './hostile.mjs';

const address = new URL(process.argv[2]);
for (let seed = 1; ; ++seed) {
  for (const run of Object.values(hostileCases)) {
    await run(address, 1, randomOf(seed));
  }
}
