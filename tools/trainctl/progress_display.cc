#include "tools/trainctl/progress_display.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

constexpr double kQuietSeconds = 1;
constexpr double kRefreshSeconds = 0.2;
// Below this a time left is a guess.
constexpr double kLeastFraction = 0.02;

bool hide_progress = false;

// Characters of UTF-8, each one column wide.
size_t Width(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  });
}

}  // namespace

void HideProgress(bool hide) { hide_progress = hide; }

std::string ProgressBar(double fraction) {
  constexpr int kWidth = 10;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int full = static_cast<int>(part * kWidth);
  return absl::StrFormat("[%s%s] %3.0f %%", std::string(full, '#'),
                         std::string(kWidth - full, ' '),
                         std::floor(100 * part));
}

ProgressDisplay::ProgressDisplay()
    : ProgressDisplay(std::cerr, isatty(STDERR_FILENO) == 1,
                      SecondsSinceStart) {}

ProgressDisplay::ProgressDisplay(std::ostream& out, bool terminal,
                                 std::function<double()> seconds)
    : out_(out),
      terminal_(terminal),
      seconds_(std::move(seconds)),
      hidden_(hide_progress) {}

Progress ProgressDisplay::progress() {
  return Progress([this](absl::string_view phase, double fraction) {
    Add(phase, fraction);
  });
}

void ProgressDisplay::Add(absl::string_view phase, double fraction) {
  std::lock_guard lock(mutex_);
  Enter(phase);
  fraction_ = std::min(1.0, fraction_ + fraction);
  ShowFraction();
}

void ProgressDisplay::Curve(const std::string& curve) {
  std::lock_guard lock(mutex_);
  curve_ = curve;
  ShowFraction();
}

void ProgressDisplay::ShowFraction() {
  std::string detail = ProgressBar(fraction_);
  if (fraction_ >= kLeastFraction) {
    const double spent = seconds_() - phase_start_;
    absl::StrAppend(&detail, ", ",
                    ClockText(spent * (1 - fraction_) / fraction_), " left");
  }
  if (!curve_.empty()) absl::StrAppend(&detail, "  ", curve_);
  Show(detail);
}

void ProgressDisplay::Count(absl::string_view phase, int64_t count) {
  std::lock_guard lock(mutex_);
  Enter(phase);
  Show(absl::StrCat(count));
}

void ProgressDisplay::Report(absl::string_view phase,
                             absl::string_view detail) {
  std::lock_guard lock(mutex_);
  Enter(phase);
  Show(std::string(detail));
}

void ProgressDisplay::Clear() {
  std::lock_guard lock(mutex_);
  if (shown_width_ == 0) return;
  out_ << "\r" << std::string(shown_width_, ' ') << "\r" << std::flush;
  shown_width_ = 0;
}

void ProgressDisplay::Enter(absl::string_view phase) {
  if (phase == phase_) return;
  phase_ = std::string(phase);
  phase_start_ = seconds_();
  fraction_ = 0;
  curve_.clear();
  announced_ = false;
  // The first line of a phase does not wait for the refresh.
  shown_at_ = 0;
}

void ProgressDisplay::Show(const std::string& detail) {
  const double now = seconds_();
  if (hidden_ || now < kQuietSeconds) return;
  if (!terminal_) {
    if (!announced_) out_ << "trainctl: " << phase_ << "\n" << std::flush;
    announced_ = true;
    return;
  }
  if (now - shown_at_ < kRefreshSeconds) return;
  const std::string line = absl::StrCat(phase_, "  ", detail);
  const size_t width = Width(line);
  const size_t blank = shown_width_ - std::min(shown_width_, width);
  out_ << "\r" << line << std::string(blank, ' ') << std::flush;
  shown_at_ = now;
  shown_width_ = width;
}

}  // namespace tactus::internal::client
