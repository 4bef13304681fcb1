#include "client/tools/trainctl/job_display.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
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

// The value that the curve is drawn of.
double CurveValue(const v1::LearningPoint& point) {
  if (point.has_loss()) return point.loss();
  if (point.has_validation_loss()) return point.validation_loss();
  return point.log_likelihood();
}

std::string ValueOf(const v1::LearningPoint& point) {
  std::vector<std::string> parts;
  const auto add = [&](bool has, const char* name, double value) {
    if (has) parts.push_back(absl::StrFormat("%s %.4g", name, value));
  };
  add(point.has_log_likelihood(), "log-likelihood", point.log_likelihood());
  add(point.has_loss(), "loss", point.loss());
  if (point.has_accuracy()) {
    parts.push_back(absl::StrCat("accuracy ", Percent(point.accuracy())));
  }
  add(point.has_validation_loss(), "validation loss", point.validation_loss());
  if (point.has_validation_accuracy()) {
    parts.push_back(absl::StrCat("validation accuracy ",
                                 Percent(point.validation_accuracy())));
  }
  return absl::StrJoin(parts, ", ");
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
  if (!curves_.empty()) {
    const std::vector<double>& curve = curves_[part_];
    absl::StrAppend(&line, "  ", Sparkline(curve, kCurveWidth),
                    absl::StrFormat(" %.4g", curve.back()));
  }
  display_.Report(progress.phase().empty() ? state : progress.phase(), line);
}

void JobDisplay::Clear() { display_.Clear(); }

void JobDisplay::Take(const v1::LearningPoint& point) {
  part_ = PartOf(point);
  curves_[part_].push_back(CurveValue(point));
  // Parts are trained side by side, so their points come mixed.
  if (!terminal_ && point.iteration() == point.max_iterations()) {
    WriteLine(absl::StrFormat("%s, iteration %d of %d: %s", part_,
                              point.iteration(), point.max_iterations(),
                              ValueOf(point)));
  }
}

void JobDisplay::WriteLine(const std::string& text) {
  out_ << "trainctl: " << text << "\n" << std::flush;
}

}  // namespace tactus::client
