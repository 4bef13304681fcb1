// File: quoted.h
//
// Text from outside, made safe for an error text or a line of a log: a client's
// name for itself, a model that it asks for, an address from the command line.
//
//   ModelNotFound: absl::StrCat("model ", Quoted(name), " does not exist")
//
// The result is one line of printable ASCII between double quotes. Quotes,
// backslashes, control characters and all bytes above 0x7e are escaped as in C,
// so that text can neither end its quotes nor begin a new line. At most
// limits::kMaxNameBytes bytes of the text are shown; "..." follows the quotes
// if there are more.
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace tactus {

std::string Quoted(absl::string_view text);

// True if `text` has no control characters (C0, DEL, C1). What a name that
// enters the server must fulfil; `text` is UTF-8.
bool IsPrintable(absl::string_view text);

}  // namespace tactus
