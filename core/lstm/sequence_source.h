// File: sequence_source.h
//
// LstmSequenceSource: training sequences that are made when a batch needs them,
// so that they need not be in memory all at once.
//
//   std::vector<LstmSequence> batch;
//   const size_t numbers[] = {4, 17};
//   source.Get(numbers, batch);  // valid until the next Get()
//
// Not thread-safe: one source per training.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/lstm/sequence.h"

namespace tactus::internal {

class LstmSequenceSource {
 public:
  virtual ~LstmSequenceSource() = default;

  virtual size_t size() const = 0;
  // Replaces `batch` by the sequences with these numbers, below size(). A
  // number gives the same sequence each time. The arrays that the sequences
  // view stay until the next call.
  virtual void Get(std::span<const size_t> numbers,
                   std::vector<LstmSequence>& batch) = 0;
};

// Sequences in memory. Refers to them.
class LstmSequencesInMemory : public LstmSequenceSource {
 public:
  explicit LstmSequencesInMemory(std::span<const LstmSequence> sequences)
      : sequences_(sequences) {}

  size_t size() const override { return sequences_.size(); }
  void Get(std::span<const size_t> numbers,
           std::vector<LstmSequence>& batch) override {
    batch.clear();
    for (const size_t number : numbers) batch.push_back(sequences_[number]);
  }

 private:
  std::span<const LstmSequence> sequences_;
};

}  // namespace tactus::internal
