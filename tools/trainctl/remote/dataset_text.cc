#include "tools/trainctl/remote/dataset_text.h"

#include <cstdint>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/bytes_text.h"
#include "core/base/text.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

std::string LabelsText(const v1::DatasetVersion& version) {
  const std::map<std::string, uint32_t> labels(version.labels().begin(),
                                               version.labels().end());
  return absl::StrJoin(labels, ", ", absl::PairFormatter(" "));
}

}  // namespace

std::string VersionText(const v1::DatasetVersion& version) {
  return absl::StrFormat("%s  %s  %s trials, %s (%s)  +%d -%d\n",
                         version.name(), TimeText(version.create_time_ms()),
                         WithCommas(version.trials()),
                         BytesText(version.bytes()), LabelsText(version),
                         version.added(), version.removed());
}

std::string OriginText(const v1::DatasetVersion& version) {
  std::vector<std::string> parts;
  const auto add = [&](uint32_t count, const char* what) {
    if (count == 0) return;
    parts.push_back(absl::StrCat(count, " ", what));
  };
  add(version.relabelled(), "relabelled");
  if (version.change() == v1::DatasetVersion::CHANGE_REMOVE) {
    add(version.removed(), "removed");
  }
  add(version.duplicates(), "duplicates left out");
  add(version.renamed(), "renamed");
  if (parts.empty()) return "";
  std::string text = absl::StrCat(absl::StrJoin(parts, ", "), " by ",
                                  Printable(version.requester()));
  if (!version.reason().empty()) {
    absl::StrAppend(&text, ": ", Printable(version.reason()));
  }
  return text + "\n";
}

}  // namespace tactus::internal::client
