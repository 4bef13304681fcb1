#include "tools/fakeskin/pty_line.h"

#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// Where a link leads; empty if there is none.
std::string LinkTarget(const std::string& link) {
  char target[PATH_MAX];
  const ssize_t length = readlink(link.c_str(), target, sizeof target);
  return length < 0 ? "" : std::string(target, static_cast<size_t>(length));
}

}  // namespace

absl::Status PtyLine::Failed() {
  const absl::Status status = IoError(
      terminal_.empty() ? "pseudo-terminal" : terminal_, std::strerror(errno));
  Close();
  return status;
}

absl::Status PtyLine::MakeRaw() {
  const int end = open(terminal_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (end < 0) return Failed();
  termios settings;
  bool made = tcgetattr(end, &settings) == 0;
  if (made) {
    cfmakeraw(&settings);
    made = tcsetattr(end, TCSANOW, &settings) == 0;
  }
  const absl::Status status = made ? absl::OkStatus() : Failed();
  // From its first closing on, the kernel knows whether a program has it open.
  close(end);
  return status;
}

absl::Status PtyLine::Open() {
  Close();
  // A link that leads nowhere is of a program that was killed. The new terminal
  // may get the number of its.
  if (!link_.empty() && access(link_.c_str(), F_OK) == 0) {
    return IoError(link_, "exists, and may be in use: remove it");
  }
  terminal_.clear();
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  char name[128];
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name, sizeof name) != 0) {
    return Failed();
  }
  terminal_ = name;
  TACTUS_RETURN_IF_ERROR(MakeRaw());
  if (link_.empty()) return absl::OkStatus();
  if (!LinkTarget(link_).empty()) unlink(link_.c_str());
  if (symlink(terminal_.c_str(), link_.c_str()) == 0) return absl::OkStatus();
  const absl::Status status = IoError(link_, std::strerror(errno));
  Close();
  return status;
}

void PtyLine::Close() {
  if (master_ < 0) return;
  if (!link_.empty() && LinkTarget(link_) == terminal_) unlink(link_.c_str());
  close(master_);
  master_ = -1;
}

bool PtyLine::IsListenedTo() const {
  if (master_ < 0) return false;
  pollfd poll = {.fd = master_, .events = 0, .revents = 0};
  return ::poll(&poll, 1, 0) == 0;
}

void PtyLine::Write(absl::string_view bytes) {
  if (!IsListenedTo()) return;
  const ssize_t count = ::write(master_, bytes.data(), bytes.size());
  // EIO: it was closed meanwhile.
  if (count < 0 && errno == EIO) return;
  if (count < 0 || static_cast<size_t>(count) < bytes.size()) ++overruns_;
}

}  // namespace tactus::internal::client
