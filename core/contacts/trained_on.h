// File: trained_on.h
//
// Which trials a model was fitted to, and whether some of them are among those
// that it is tested on. A test on trials that the model knows says nothing
// about new ones.
//
//   SetTrainedOn(contacts, model.provenance);
//   const TrainedOn trained = FindTrainedOn(
//       model.provenance, contacts, {.sha256 = loaded.data_sha256});
//   if (trained.contacts > 0) std::cout << TrainedOnText(trained);
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "core/classify/model.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// The values of v1::TrainingBasis.
enum class TrainingBasis { kUnknown, kFrames, kData, kName };

struct TrainedOn {
  TrainingBasis basis = TrainingBasis::kUnknown;
  // How many of the tested contacts the model was fitted to.
  int contacts = 0;
  int tested = 0;
};

// The data that a model is tested on.
struct TestedData {
  // As Provenance::data_sha256; empty if unknown.
  std::string sha256 = {};
  // As Provenance::data.
  std::string name = {};
};

// Notes how many groups and conditions the contacts have, and their
// fingerprints unless there are too many; nothing of contacts without
// fingerprints.
void SetTrainedOn(const std::vector<const LabelledContact*>& contacts,
                  Provenance& provenance);

// Compares frames if the bundle names its trials and the contacts have
// fingerprints, else the data as a whole, else their names.
TrainedOn FindTrainedOn(const Provenance& provenance,
                        const std::vector<const LabelledContact*>& contacts,
                        const TestedData& data);

// One line, without an end of line, that says how far the test is no test;
// empty if it is one.
std::string TrainedOnText(const TrainedOn& trained);

// FingerprintOfAll of the contacts; empty if one has no fingerprint.
std::string DataSha256(const std::vector<const LabelledContact*>& contacts);

}  // namespace tactus::internal
