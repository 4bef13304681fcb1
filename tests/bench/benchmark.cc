#include "tests/bench/benchmark.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

template <typename T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json OrNull(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

}  // namespace

std::optional<double> BenchRow::Ratio() const {
  if (!peer) return std::nullopt;
  return unit == "1/s" ? ours / *peer : *peer / ours;
}

std::string RowsToJson(const std::vector<BenchRow>& rows) {
  Json json = Json::array();
  for (const BenchRow& row : rows) {
    json.push_back({{"name", row.name},
                    {"unit", row.unit},
                    {"ours", row.ours},
                    {"peer", OrNull(row.peer)},
                    {"peer_name", OrNull(row.peer_name)},
                    {"ratio", OrNull(row.Ratio())},
                    {"error", OrNull(row.error)},
                    {"error_reference", OrNull(row.error_reference)},
                    {"accuracy", OrNull(row.accuracy)}});
  }
  return JsonText(json, 1);
}

std::string RowsToText(const std::vector<BenchRow>& rows) {
  size_t width = 26;
  for (const BenchRow& row : rows) width = std::max(width, row.name.size());
  const int name_width = static_cast<int>(width);
  std::string text =
      absl::StrFormat("%-*s %12s %12s %8s  %-4s  %s\n", name_width, "name",
                      "ours", "peer", "ratio", "unit", "peer, error");
  for (const BenchRow& row : rows) {
    std::vector<std::string> notes;
    if (!row.peer_name.empty()) {
      notes.push_back(row.peer ? row.peer_name
                               : row.peer_name + " is not installed");
    }
    if (row.error) {
      notes.push_back(
          absl::StrFormat("error %.2g to %s", *row.error, row.error_reference));
    }
    if (row.accuracy) {
      notes.push_back(absl::StrFormat("%.2f %% right", 100 * *row.accuracy));
    }
    absl::StrAppendFormat(
        &text, "%-*s %12.6g %12s %8s  %-4s  %s\n", name_width, row.name,
        row.ours, row.peer ? absl::StrFormat("%.6g", *row.peer) : "-",
        row.Ratio() ? absl::StrFormat("%.2f", *row.Ratio()) : "-", row.unit,
        absl::StrJoin(notes, "; "));
  }
  return text;
}

}  // namespace tactus::internal::client
