// File: trial_id.h
//
// The rule for ids of trials, which files, imports, uploads and exports share,
// and the name of a trial for people.
//
//   const std::string fault = TrialIdFault(trial.id);
//   if (!fault.empty()) return complain("id", fault);
//
//   TrialIds ids;
//   trial.id = ids.Unique(trial.id);  // "touch 1" -> "touch_1"
//
// Thread-safe, except that a TrialIds belongs to one thread.
#pragma once

#include <set>
#include <string>

#include "absl/strings/string_view.h"
#include "core/data/trial.h"

namespace tactus::internal {

// Says what is wrong with an id, to be put after its name. Empty if it has 1 to
// limits::kMaxTrialIdBytes letters, digits, - or _.
std::string TrialIdFault(absl::string_view id);

// An id made of any text: _ in place of each other byte, cut to the longest
// id. "trial" for an empty text.
std::string SafeTrialId(absl::string_view text);

// What reports call a trial: the recording that it was made from, or its id.
inline const std::string& TrialName(const std::string& id,
                                    const std::string& source) {
  return source.empty() ? id : source;
}

// Hands out ids, each once.
class TrialIds {
 public:
  // Takes an id that is in use already.
  void Add(const std::string& id) { used_.insert(id); }
  bool Has(const std::string& id) const { return used_.contains(id); }
  // SafeTrialId of `wanted` if nobody has it, else the same with "-2" behind
  // it, or the next number that is free.
  std::string Unique(absl::string_view wanted);

 private:
  std::set<std::string> used_;
};

}  // namespace tactus::internal
