#include "core/import/mistakes.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

constexpr size_t kShownMistakes = 20;

// Takes "line 17: " off the front of `text` and returns "line 17".
std::string TakeLine(absl::string_view* text) {
  absl::string_view rest = *text;
  if (!absl::ConsumePrefix(&rest, "line ")) return "";
  size_t digits = 0;
  while (digits < rest.size() && absl::ascii_isdigit(rest[digits])) ++digits;
  const std::string line = absl::StrCat("line ", rest.substr(0, digits));
  rest.remove_prefix(digits);
  if (!absl::ConsumePrefix(&rest, ": ")) return "";
  *text = rest;
  return line;
}

}  // namespace

absl::Status Mistakes::Add(const std::string& file,
                           const absl::Status& status) {
  if (status.ok() || ReasonOf(status) != "TRIAL_FILE_INVALID") return status;
  if (count_++ == 0) first_ = status;
  absl::string_view text = status.message();
  absl::ConsumePrefix(&text, absl::StrCat(path_, ": "));
  absl::string_view rest = text;
  const std::string line = TakeLine(&rest);
  const std::string key = file.empty()
                              ? std::string(rest)
                              : absl::StrReplaceAll(rest, {{file, ""}});
  const auto known = places_.find(key);
  if (known != places_.end()) {
    Kind& kind = kinds_[known->second];
    if (kind.again.size() + 1 < kShownMistakes) {
      kind.again.push_back(absl::StrCat(line, " (", file, ")"));
    } else {
      ++kind.more;
    }
  } else if (kinds_.size() < kShownMistakes) {
    places_[key] = kinds_.size();
    kinds_.push_back({.text = std::string(text), .again = {}, .more = 0});
  } else {
    ++not_shown_;
  }
  return absl::OkStatus();
}

absl::Status Mistakes::Status() const {
  if (count_ < 2) return first_;
  std::string text = absl::StrCat("has ", count_, " mistakes:");
  for (size_t i = 0; i < kinds_.size(); ++i) {
    const Kind& kind = kinds_[i];
    absl::StrAppend(&text, " (", i + 1, ") ", kind.text);
    if (kind.again.empty()) continue;
    absl::StrAppend(&text, "; the same in ", absl::StrJoin(kind.again, ", "));
    if (kind.more > 0) absl::StrAppend(&text, " and ", kind.more, " more");
  }
  if (not_shown_ > 0) absl::StrAppend(&text, " and ", not_shown_, " more");
  return TrialFileInvalid(path_, text);
}

}  // namespace tactus::internal
