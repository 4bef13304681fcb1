#include "tools/console/import_target.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace tactus::internal::console {
namespace {

constexpr absl::string_view kImports = "/api/import/";
constexpr std::pair<absl::string_view, ImportStep> kSteps[] = {
    {"begin", ImportStep::kBegin},
    {"file", ImportStep::kFile},
    {"check", ImportStep::kCheck},
    {"finish", ImportStep::kFinish},
    {"end", ImportStep::kEnd}};

// "a%20b" as "a b".
std::optional<std::string> PercentDecoded(absl::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const absl::string_view digits = text.substr(i + 1, 2);
    if (digits.size() != 2 || !absl::ascii_isxdigit(digits[0]) ||
        !absl::ascii_isxdigit(digits[1])) {
      return std::nullopt;
    }
    decoded += absl::HexStringToBytes(digits);
    i += digits.size();
  }
  return decoded;
}

}  // namespace

bool IsImport(absl::string_view target) {
  return absl::StartsWith(target, kImports);
}

std::optional<ImportTarget> FindImportStep(absl::string_view target) {
  if (!absl::ConsumePrefix(&target, kImports)) return std::nullopt;
  const std::pair<absl::string_view, absl::string_view> halves =
      absl::StrSplit(target, absl::MaxSplits('?', 1));
  const std::vector<absl::string_view> path = absl::StrSplit(halves.first, '/');
  ImportTarget found;
  // SimpleAtoi takes signs and spaces.
  if (path.size() != 2 || path[0].empty() || path[0].size() > 2 ||
      !std::ranges::all_of(path[0], absl::ascii_isdigit) ||
      !absl::SimpleAtoi(path[0], &found.server)) {
    return std::nullopt;
  }
  const auto* step =
      std::ranges::find(kSteps, path[1], [](const auto& s) { return s.first; });
  if (step == std::end(kSteps)) return std::nullopt;
  found.step = step->second;
  for (const absl::string_view part :
       absl::StrSplit(halves.second, '&', absl::SkipEmpty())) {
    const std::pair<absl::string_view, absl::string_view> pair =
        absl::StrSplit(part, absl::MaxSplits('=', 1));
    auto value = PercentDecoded(pair.second);
    if (!value) return std::nullopt;
    if (pair.first == "id") {
      found.id = *std::move(value);
    } else if (pair.first == "name") {
      found.name = *std::move(value);
    } else if (pair.first == "replace") {
      found.replaces = *value == "1";
    } else {
      return std::nullopt;
    }
  }
  return found;
}

}  // namespace tactus::internal::console
