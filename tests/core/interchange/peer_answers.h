// File: peer_answers.h
//
// Files of other programs, with inputs and the posteriors that the program
// itself computes: a JSON file that peers.py writes beside them. Test-only.
//
//   for (const PeerAnswer& answer : ReadPeerAnswers(folder + "/torch.json")) {
//     LargestDifference(Posteriors(read.lstms, answer.inputs),
//                       answer.probability);
//   }
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {

struct PeerAnswer {
  // Name of the file, in the folder of the JSON file.
  std::string file;
  Rows inputs;
  // One row per frame, or one row for the last frame.
  Rows probability;
};

inline std::vector<PeerAnswer> ReadPeerAnswers(const std::string& path) {
  std::ifstream in(path);
  const nlohmann::json json = nlohmann::json::parse(in);
  std::vector<PeerAnswer> answers;
  for (const nlohmann::json& row : json["answers"]) {
    answers.push_back({row["file"].get<std::string>(),
                       row["inputs"].get<Rows>(),
                       row["probability"].get<Rows>()});
  }
  return answers;
}

// Between the posteriors of `networks` and the answer.
inline double Difference(const std::vector<LstmNetwork>& networks,
                         const PeerAnswer& answer) {
  Rows rows = Posteriors(networks, answer.inputs);
  if (answer.probability.size() == 1) rows = {rows.back()};
  return LargestDifference(rows, answer.probability);
}

}  // namespace tactus::internal
