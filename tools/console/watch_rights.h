// File: watch_rights.h
//
// Who may watch robots with another program than the console's own page.
//
//   if (IsLocalProgram(request, is_loopback) && !doorkeeper.is_open()) {
//     AskServersFirst();
//   }
//   const auto person = FindWatcher(request, doorkeeper, is_loopback);
//   if (person == nullptr) return Forbidden();
//
// A program like Foxglove has no cookie of the console, and if it runs in a
// browser it comes from another site. So a request may give the key of a
// sign-in, and then comes from wherever it likes. Without one, it is a
// stranger's unless the console's own page sends it. Thread-safe: free
// functions without state.
#pragma once

#include "tools/console/doorkeeper.h"
#include "tools/console/responses.h"

namespace tactus::internal::console {

// True if a request without a key comes from a program of the console's host
// that is no browser. It may see what servers show to everybody there, because
// it can ask them itself. `is_loopback`: the console listens on its own host
// alone.
bool IsLocalProgram(const Request& request, bool is_loopback);

// Null if nobody's right comes with the request.
Doorkeeper::Person FindWatcher(const Request& request,
                               const Doorkeeper& doorkeeper, bool is_loopback);

}  // namespace tactus::internal::console
