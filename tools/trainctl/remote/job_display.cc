#include "tools/trainctl/remote/job_display.h"

#include <unistd.h>

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

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

bool IsLikelihood(const v1::LearningPoint& point) {
  return !point.has_loss() && !point.has_validation_loss();
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
      "%s  %s elapsed", ProgressBar(progress.fraction()),
      ClockText(1e-3 * static_cast<double>(progress.elapsed_ms())));
  if (progress.remaining_ms() > 0) {
    absl::StrAppend(
        &line, ", ",
        ClockText(1e-3 * static_cast<double>(progress.remaining_ms())),
        " left");
  }
  if (const std::string curve = curves_.Text(); !curve.empty()) {
    absl::StrAppend(&line, "  ", curve);
  }
  display_.Report(progress.phase().empty() ? state : progress.phase(), line);
}

void JobDisplay::Clear() { display_.Clear(); }

void JobDisplay::Take(const v1::LearningPoint& point) {
  const std::string part = PartOf(point);
  curves_.Add(part, CurveValue(point), IsLikelihood(point));
  // Parts are trained side by side, so their points come mixed.
  if (!terminal_ && point.iteration() == point.max_iterations()) {
    WriteLine(absl::StrFormat("%s, iteration %d of %d: %s", part,
                              point.iteration(), point.max_iterations(),
                              ValueOf(point)));
  }
}

void JobDisplay::WriteLine(const std::string& text) {
  out_ << "trainctl: " << text << "\n" << std::flush;
}

}  // namespace tactus::internal::client
