#include "core/data/trial_id.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

bool IsIdByte(unsigned char c) {
  return absl::ascii_isalnum(c) || c == '-' || c == '_';
}

}  // namespace

std::string TrialIdFault(absl::string_view id) {
  if (!id.empty() && id.size() <= limits::kMaxTrialIdBytes &&
      std::all_of(id.begin(), id.end(), IsIdByte)) {
    return "";
  }
  return absl::StrCat("is ", Quoted(id), "; it must be 1 to ",
                      limits::kMaxTrialIdBytes, " letters, digits, - or _");
}

std::string SafeTrialId(absl::string_view text) {
  if (text.empty()) return "trial";
  std::string id(text.substr(0, limits::kMaxTrialIdBytes));
  for (char& c : id) {
    if (!IsIdByte(static_cast<unsigned char>(c))) c = '_';
  }
  return id;
}

std::string TrialIds::Unique(absl::string_view wanted) {
  const std::string base = SafeTrialId(wanted);
  std::string id = base;
  for (int number = 2; !used_.insert(id).second; ++number) {
    const std::string ending = absl::StrCat("-", number);
    id = absl::StrCat(base.substr(0, limits::kMaxTrialIdBytes - ending.size()),
                      ending);
  }
  return id;
}

}  // namespace tactus::internal
