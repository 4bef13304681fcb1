#include "tools/trainctl/fit/learning_curves.h"

#include <span>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/trainctl/sparkline.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kWidth = 12;

}  // namespace

void LearningCurves::Add(const std::string& part, double value,
                         bool likelihood) {
  part_ = part;
  likelihood_ = likelihood;
  curves_[part].push_back(value);
}

std::string LearningCurves::Text() const {
  const auto curve = curves_.find(part_);
  if (curve == curves_.end()) return "";
  std::span<const double> values(curve->second);
  if (likelihood_ && values.size() > 2) values = values.subspan(1);
  return absl::StrCat(Sparkline(values, kWidth),
                      absl::StrFormat(" %.4g", values.back()));
}

}  // namespace tactus::internal::client
