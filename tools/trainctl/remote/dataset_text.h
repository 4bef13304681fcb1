// File: dataset_text.h
//
// Dataset versions as lines of text.
//
//   std::cout << VersionText(version) << OriginText(version);
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "tactus/v1/training.pb.h"

namespace tactus::internal::client {

// One line: name, time, trials and their labels, what was added and removed.
std::string VersionText(const v1::DatasetVersion& version);

// One line that says who changed what and why, or what became of uploaded
// trials that were there already; empty if there is nothing to say.
std::string OriginText(const v1::DatasetVersion& version);

}  // namespace tactus::internal::client
