#include "core/contacts/trained_on.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/data/frame_fingerprint.h"

namespace tactus::internal {
namespace {

// The first 64 bits.
uint64_t Prefix(const std::string& fingerprint) {
  uint64_t bits = 0;
  std::from_chars(fingerprint.data(),
                  fingerprint.data() + std::min<size_t>(16, fingerprint.size()),
                  bits, 16);
  return bits;
}

bool AllHaveFingerprints(const std::vector<const LabelledContact*>& contacts) {
  return std::ranges::none_of(contacts, [](const LabelledContact* contact) {
    return contact->fingerprint.empty();
  });
}

uint32_t CountDistinct(const std::vector<const LabelledContact*>& contacts,
                       std::string LabelledContact::*field) {
  std::set<std::string> values;
  for (const LabelledContact* contact : contacts) {
    values.insert(contact->*field);
  }
  return static_cast<uint32_t>(values.size());
}

}  // namespace

void SetTrainedOn(const std::vector<const LabelledContact*>& contacts,
                  Provenance& provenance) {
  std::vector<uint64_t>& known = provenance.trial_fingerprints;
  known.clear();
  provenance.groups = provenance.conditions = 0;
  if (!AllHaveFingerprints(contacts)) return;
  provenance.groups = CountDistinct(contacts, &LabelledContact::material);
  provenance.conditions = CountDistinct(contacts, &LabelledContact::condition);
  for (const LabelledContact* contact : contacts) {
    if (!IdentifiesRecording(contact->fingerprint)) continue;
    known.push_back(Prefix(contact->fingerprint));
  }
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  if (known.size() > limits::kMaxProvenanceTrials) known.clear();
}

TrainedOn FindTrainedOn(const Provenance& provenance,
                        const std::vector<const LabelledContact*>& contacts,
                        const TestedData& data) {
  TrainedOn trained;
  trained.tested = static_cast<int>(contacts.size());
  const std::vector<uint64_t>& known = provenance.trial_fingerprints;
  bool all = false;
  if (!known.empty() && AllHaveFingerprints(contacts)) {
    trained.basis = TrainingBasis::kFrames;
    trained.contacts = static_cast<int>(
        std::ranges::count_if(contacts, [&](const LabelledContact* contact) {
          return IdentifiesRecording(contact->fingerprint) &&
                 std::ranges::binary_search(known,
                                            Prefix(contact->fingerprint));
        }));
    return trained;
  }
  if (!provenance.data_sha256.empty() && !data.sha256.empty()) {
    trained.basis = TrainingBasis::kData;
    all = provenance.data_sha256 == data.sha256;
  } else if (!data.name.empty() && provenance.data == data.name) {
    trained.basis = TrainingBasis::kName;
    all = true;
  }
  if (all) trained.contacts = trained.tested;
  return trained;
}

std::string TrainedOnText(const TrainedOn& trained) {
  if (trained.contacts == 0) {
    return trained.basis != TrainingBasis::kUnknown
               ? ""
               : "The bundle does not say which trials it was fitted to: if "
                 "they are among these, the accuracy says nothing about new "
                 "ones";
  }
  std::string text =
      trained.contacts == trained.tested
          ? absl::StrCat("No test: the model was fitted to all ",
                         trained.tested,
                         " contacts that it is tested on; the accuracy says "
                         "nothing about new ones")
          : absl::StrCat("Partly no test: the model was fitted to ",
                         trained.contacts, " of the ", trained.tested,
                         " contacts that it is tested on; the accuracy says "
                         "too much about new ones");
  if (trained.basis == TrainingBasis::kName) {
    text += " (the bundle names a file of this name)";
  }
  return text;
}

std::string DataSha256(const std::vector<const LabelledContact*>& contacts) {
  if (!AllHaveFingerprints(contacts)) return "";
  std::vector<std::string> fingerprints;
  fingerprints.reserve(contacts.size());
  for (const LabelledContact* contact : contacts) {
    fingerprints.push_back(contact->fingerprint);
  }
  return FingerprintOfAll(std::move(fingerprints));
}

}  // namespace tactus::internal
