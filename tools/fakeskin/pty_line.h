// File: pty_line.h
//
// PtyLine: a serial line of this machine whose device end is this process: a
// pseudo-terminal, with a symbolic link to it if its path shall not change.
//
//   PtyLine line("/tmp/anyskin");
//   TACTUS_RETURN_IF_ERROR(line.Open());
//   if (line.IsListenedTo()) line.Write(bytes);
//
// Write does not wait. While no program has the line open, nothing is kept for
// it; what a program does not read in time is lost, a whole message or the rest
// of one. Closing the line is pulling the device out. Not thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class PtyLine {
 public:
  // Without a link if it is empty.
  explicit PtyLine(std::string link) : link_(std::move(link)) {}
  ~PtyLine() { Close(); }

  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;

  // IO, also if the link's path leads to something that exists.
  absl::Status Open();
  // Removes the link. Without effect on a closed line.
  void Close();

  // What a program opens: the link, or the pseudo-terminal.
  const std::string& path() const { return link_.empty() ? terminal_ : link_; }
  // Some program has it open.
  bool IsListenedTo() const;
  void Write(absl::string_view bytes);
  // Messages that were cut or dropped because nobody read them in time.
  uint64_t overruns() const { return overruns_; }

 private:
  absl::Status MakeRaw();
  absl::Status Failed();

  const std::string link_;
  std::string terminal_;
  int master_ = -1;
  uint64_t overruns_ = 0;
};

}  // namespace tactus::internal::client
