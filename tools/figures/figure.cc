#include "tools/figures/figure.h"

#include "core/base/status_macros.h"
#include "tools/figures/gnuplot.h"

namespace tactus::internal::client {

absl::StatusOr<std::string> FigureAsPng(const Figure& figure) {
  TACTUS_ASSIGN_OR_RETURN(
      const GnuplotScript script,
      std::visit([](const auto& chart) { return ScriptOf(chart); }, figure));
  return RunGnuplot(script.text());
}

absl::Status DrawFigure(const Figure& figure, const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(
      const GnuplotScript script,
      std::visit([](const auto& chart) { return ScriptOf(chart); }, figure));
  return DrawToFile(script.text(), path);
}

}  // namespace tactus::internal::client
