#include "client/drivers/serial/low_latency.h"

#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"

namespace tactus::internal::client {
namespace {

int KernelControl(int file, unsigned long request, serial_struct* line) {
  return ::ioctl(file, request, line) == 0 ? 0 : errno;
}

// Errors of lines that have no such settings.
bool IsAbsence(int error) {
  return error == ENOTTY || error == EINVAL || error == EOPNOTSUPP ||
         error == ENOSYS;
}

}  // namespace

LowLatency::LowLatency(int file) : LowLatency(file, KernelControl) {}

LowLatency::LowLatency(int file, Control control)
    : file_(file), control_(std::move(control)) {
  Ask();
}

LowLatency::~LowLatency() {
  serial_struct line = {};
  if (!changed_ || control_(file_, TIOCGSERIAL, &line) != 0) return;
  line.flags &= ~ASYNC_LOW_LATENCY;
  control_(file_, TIOCSSERIAL, &line);
}

void LowLatency::Ask() {
  serial_struct line = {};
  error_ = control_(file_, TIOCGSERIAL, &line);
  if (error_ == 0 && (line.flags & ASYNC_LOW_LATENCY) == 0) {
    line.flags |= ASYNC_LOW_LATENCY;
    error_ = control_(file_, TIOCSSERIAL, &line);
    changed_ = error_ == 0;
    // Some drivers take any flags and keep none.
    line = {};
    if (changed_) error_ = control_(file_, TIOCGSERIAL, &line);
  }
  if (error_ != 0) {
    answer_ = IsAbsence(error_) ? Answer::kAbsent : Answer::kRefused;
  } else {
    answer_ =
        (line.flags & ASYNC_LOW_LATENCY) != 0 ? Answer::kOn : Answer::kIgnored;
  }
}

std::string LowLatency::ToText(const std::string& path,
                               const std::string& devices) const {
  std::string text;
  switch (answer_) {
    case Answer::kOn:
      text = "low latency is on";
      break;
    case Answer::kIgnored:
      text = "low latency was asked for, and the line ignores it";
      break;
    case Answer::kAbsent:
      text = "the line has no setting for low latency";
      break;
    case Answer::kRefused:
      text = absl::StrCat("low latency was refused: ", std::strerror(error_));
      break;
  }
  // Adapters of FTDI.
  std::error_code ignored;
  const std::filesystem::path target =
      std::filesystem::canonical(path, ignored);
  std::ifstream timer(devices + "/" + target.filename().string() +
                      "/device/latency_timer");
  int ms = 0;
  if (timer >> ms)
    absl::StrAppend(&text, "; the adapter's timer is ", ms, " ms");
  return text;
}

}  // namespace tactus::internal::client
