// File: terminal.h
//
// Terminal: a screen that is drawn again and again, and single keys.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto terminal,
//                           Terminal::Open("--monitor"));
//   while (!terminal->interrupted()) {
//     terminal->Draw(lines);
//     while (const auto key = terminal->ReadKey()) Use(*key);
//   }
//
// While it exists, keys come at once and are not shown, the terminal's other
// contents are out of sight, and SIGINT, SIGTERM and SIGHUP make interrupted()
// true. The destructor restores everything. One may exist at a time. Not
// thread-safe.
#pragma once

#include <termios.h>

#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

struct TerminalSize {
  int columns = 80;
  int rows = 24;
};

class Terminal {
 public:
  // INVALID_CONFIG, which begins with `what`, if standard input or output is no
  // terminal.
  static absl::StatusOr<std::unique_ptr<Terminal>> Open(absl::string_view what);
  ~Terminal();

  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // As it is now: a user may change it at any time.
  TerminalSize Size() const;
  // False if the environment forbids colours (NO_COLOR, TERM=dumb) or if its
  // locale is not UTF-8.
  bool colour() const { return colour_; }
  // Replaces the screen.
  void Draw(const std::vector<std::string>& lines);
  // The next key that was pressed; nothing if there is none.
  std::optional<char> ReadKey();
  // Somebody wants the program to end.
  bool interrupted() const;

 private:
  Terminal();

  const bool colour_;
  termios before_ = {};
  TerminalSize drawn_ = {};
  struct sigaction actions_[3] = {};
};

// The rule of colour().
bool UsesColour(const char* no_color, const char* term, const char* locale);

}  // namespace tactus::internal::client
