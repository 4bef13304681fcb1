#include "client/tools/trainctl/job_display.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/trainctl/command.h"
#include "client/tools/trainctl/proto_json.h"
#include "client/tools/trainctl/sparkline.h"
#include "client/tools/trainctl/text.h"

namespace tactus::client {
namespace {

constexpr int kBarWidth = 10;
constexpr size_t kCurveWidth = 12;

std::string Bar(double fraction) {
  const int full = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarWidth);
  return absl::StrCat("[", std::string(full, '#'),
                      std::string(kBarWidth - full, ' '), "]");
}

std::string PartOf(const v1::LearningPoint& point) {
  return absl::StrCat(point.phase(), point.part().empty() ? "" : " ",
                      point.part());
}

std::string ValueOf(const v1::LearningPoint& point) {
  const bool loss = absl::StrContains(point.phase(), "LSTM");
  std::string text = absl::StrFormat(
      "%s %.4g", loss ? "loss" : "log-likelihood", point.train_value());
  if (point.has_validation_value()) {
    absl::StrAppendFormat(&text, ", validation %.4g", point.validation_value());
  }
  if (point.has_accuracy()) {
    absl::StrAppend(&text, ", accuracy ", Percent(point.accuracy()));
  }
  return text;
}

}  // namespace

JobDisplay::JobDisplay()
    : JobDisplay(std::cerr, isatty(STDERR_FILENO) == 1, SecondsSinceStart) {}

JobDisplay::JobDisplay(std::ostream& out, bool terminal,
                       std::function<double()> seconds)
    : out_(out),
      terminal_(terminal),
      display_(out, terminal, std::move(seconds)) {}

void JobDisplay::Update(const v1::Operation& operation,
                        std::span<const v1::LearningPoint> points) {
  for (const v1::LearningPoint& point : points) Take(point);
  const std::string state = EnumText(
      *v1::Operation::State_descriptor()->FindValueByNumber(operation.state()));
  if (!terminal_) {
    if (operation.state() != state_) {
      EndPart();
      WriteLine(absl::StrCat(operation.name(), " ", state));
    }
    state_ = operation.state();
    return;
  }
  const v1::OperationProgress& progress = operation.progress();
  std::string line = absl::StrFormat(
      "%s %3.0f %%  %s elapsed", Bar(progress.fraction()),
      std::floor(100 * progress.fraction()),
      ClockText(1e-3 * static_cast<double>(progress.elapsed_ms())));
  if (progress.remaining_ms() > 0) {
    absl::StrAppend(
        &line, ", ",
        ClockText(1e-3 * static_cast<double>(progress.remaining_ms())),
        " left");
  }
  if (!curve_.empty()) {
    absl::StrAppend(&line, "  ", Sparkline(curve_, kCurveWidth),
                    absl::StrFormat(" %.4g", curve_.back()));
  }
  display_.Report(progress.phase().empty() ? state : progress.phase(), line);
}

void JobDisplay::Clear() {
  EndPart();
  display_.Clear();
}

void JobDisplay::Take(const v1::LearningPoint& point) {
  if (PartOf(point) != PartOf(last_point_)) {
    EndPart();
    curve_.clear();
  }
  last_point_ = point;
  curve_.push_back(point.train_value());
}

void JobDisplay::WriteLine(const std::string& text) {
  out_ << "trainctl: " << text << "\n" << std::flush;
}

void JobDisplay::EndPart() {
  if (!terminal_ && last_point_.iteration() > 0) {
    WriteLine(absl::StrFormat("%s, iteration %d of %d: %s", PartOf(last_point_),
                              last_point_.iteration(),
                              last_point_.max_iterations(),
                              ValueOf(last_point_)));
  }
  last_point_.Clear();
}

}  // namespace tactus::client
