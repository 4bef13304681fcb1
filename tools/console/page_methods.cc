#include "tools/console/page_methods.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/limits_console.h"

namespace tactus::internal::console {
namespace {

constexpr absl::string_view kRoot = "/api/servers/";

}  // namespace

std::string PageMethod::FullName() const {
  return absl::StrCat(package, ".", service, ".", name);
}

std::string PageMethod::Path() const {
  return absl::StrCat("/", package, ".", service, "/", name);
}

const std::vector<PageMethod>& PageMethods() {
  static const auto* const methods = new std::vector<PageMethod>{
      {"AdminService", "Drain"},
      {"AdminService", "GetServerInfo"},
      {"AdminService", "ListAuditLog"},
      {"ContactLogService", "LabelContacts"},
      {"ContactLogService", "ListContacts"},
      {"ContactLogService", "ReplayContact"},
      {"Health", "Check", PageAnswer::kOne, "grpc.health.v1"},
      {"ModelService", "ListAliasHistory"},
      {"ModelService", "ListAliases"},
      {"ModelService", "ListModelVersions"},
      {"ModelService", "PromoteModel"},
      {"ModelService", "RollbackAlias"},
      {"ModelService", "UpdateAlias"},
      {"MonitorService", "ListStreams"},
      {"OperationService", "CancelOperation"},
      {"OperationService", "GetOperation"},
      {"OperationService", "ListOperations"},
      {"OperationService", "ReadOperationLog", PageAnswer::kAll},
      {"OperationService", "WatchOperation", PageAnswer::kFirst},
      {"TrainingService", "CreateDataset"},
      {"TrainingService", "EvaluateModel"},
      {"TrainingService", "GetDataset"},
      {"TrainingService", "ListDatasets"},
      {"TrainingService", "ListTrials"},
      {"TrainingService", "RelabelTrials"},
      {"TrainingService", "RemoveTrials"},
      {"TrainingService", "TrainModel"},
  };
  return *methods;
}

bool IsPageCall(absl::string_view path) {
  return absl::StartsWith(path, kRoot);
}

std::optional<PageTarget> FindPageMethod(absl::string_view path) {
  if (!absl::ConsumePrefix(&path, kRoot)) return std::nullopt;
  const std::vector<absl::string_view> parts = absl::StrSplit(path, '/');
  if (parts.size() != 3) return std::nullopt;
  PageTarget target;
  // SimpleAtoi takes signs and spaces.
  const bool is_number = !parts[0].empty() && parts[0].size() <= 2 &&
                         std::ranges::all_of(parts[0], [](char c) {
                           return c >= '0' && c <= '9';
                         });
  if (!is_number || !absl::SimpleAtoi(parts[0], &target.server)) {
    return std::nullopt;
  }
  const auto& methods = PageMethods();
  const auto found = std::ranges::find_if(methods, [&](const auto& method) {
    return method.service == parts[1] && method.name == parts[2];
  });
  if (found == methods.end()) return std::nullopt;
  target.method = &*found;
  return target;
}

}  // namespace tactus::internal::console
