// File: text.h
//
// Checks of text that enters Tactus: labels, names and notes from files, flags
// and messages. Text is UTF-8 on one line, so that every log, terminal and JSON
// reader takes it.
//
//   const std::string fault = TextFault(label, limits::kMaxTrialTextBytes);
//   if (!fault.empty()) return complain("label", fault);
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// True if `text` is well-formed UTF-8 (RFC 3629): no overlong forms, no
// surrogates, nothing above U+10FFFF.
bool IsUtf8(absl::string_view text);

// Says what is wrong with `text`, to be put after its name: "has 300 bytes; it
// must have at most 256". Empty if the text is UTF-8 without control characters
// (U+0000 to U+001F, U+007F to U+009F) and has at most `max_bytes` bytes.
std::string TextFault(absl::string_view text, size_t max_bytes);

// `text` with a question mark in place of each byte that is not UTF-8 and of
// each control character.
std::string Printable(absl::string_view text);

// `text` for an error text or a line of a log: printable ASCII between double
// quotes. Quotes, backslashes, control characters and bytes above 0x7e are
// escaped as in C, so `text` can neither end its quotes nor begin a new line.
// At most limits::kMaxNameBytes bytes are shown; "..." follows if there are
// more.
std::string Quoted(absl::string_view text);

}  // namespace tactus::internal
