// File: cue_table.h
//
// CueTable: the cues of contacts and their copies before they are scaled, at
// each step. What scales them needs all of them first, and what trains needs
// them again.
//
//   CueTable table(contacts, cues, {.steps = {5, 20}});
//   table.Walk(RunOnThreads, [&](std::span<const double> values) {
//     for (size_t i = 0; i < values.size(); ++i) ranges[i].Add(values[i]);
//   });
//   for (size_t step = 0; step < table.steps(3); ++step) {
//     Use(table.values(3, step));
//   }
//
// Refers to the contacts. Not thread-safe while it walks.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/base/work.h"
#include "core/classify/input_spec.h"
#include "core/contacts/varied_contacts.h"

namespace tactus::internal {

class CueTable {
 public:
  struct Options {
    StepIntervals steps = {};
    // For cues made from taxels, without which they are 0. Not owned.
    const TaxelEmbedding* embedding = nullptr;
    // The values are kept after Walk() if they take at most so many bytes.
    size_t kept_bytes = 0;
  };

  // An empty table, which keeps nothing.
  CueTable() = default;
  CueTable(const VariedContacts& contacts, std::vector<Cue> cues,
           const Options& options);

  // Calls `visit` with the values of the cues at each step of the first
  // contact, then of the second, and so on, on the calling thread. The values
  // are made on all threads.
  void Walk(const ParallelFor& parallel,
            absl::FunctionRef<void(std::span<const double> values)> visit);

  // True if the values of all contacts are here: they were walked, and they are
  // few enough.
  bool kept() const { return !begins_.empty(); }
  // The number of steps of a contact, and the values of the cues at one of
  // them. Of a table that is kept.
  size_t steps(size_t contact) const {
    return begins_[contact + 1] - begins_[contact];
  }
  std::span<const double> values(size_t contact, size_t step) const {
    return std::span(values_).subspan((begins_[contact] + step) * cues_.size(),
                                      cues_.size());
  }

 private:
  // Contacts that one thread walks.
  struct Block {
    size_t begin = 0;
    size_t end = 0;
    std::vector<double> values = {};
    // Steps of each contact.
    std::vector<size_t> steps = {};
  };

  // Bytes of a contact's values at most: a copy has no more frames than its
  // contact.
  size_t MostBytes(size_t contact) const {
    return most_steps_[contact % most_steps_.size()] * cues_.size() *
           sizeof(double);
  }
  // The next blocks from contact `begin` on, as many as there is room for.
  std::vector<Block> NextBlocks(size_t begin) const;
  void Fill(Block& block) const;
  void Keep(const Block& block);

  const VariedContacts* contacts_ = nullptr;
  std::vector<Cue> cues_;
  Options options_;
  // Steps of the contacts that are no copies.
  std::vector<size_t> most_steps_;
  std::vector<double> values_;
  // Steps before each contact, and of all.
  std::vector<size_t> begins_;
};

}  // namespace tactus::internal
