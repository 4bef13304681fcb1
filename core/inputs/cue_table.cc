#include "core/inputs/cue_table.h"

#include <algorithm>
#include <utility>

#include "core/inputs/inputs.h"

namespace tactus::internal {
namespace {

// Bytes of a block of values, which takes about a millisecond to make, and of
// the blocks that threads share out before they are visited.
constexpr size_t kBlockBytes = size_t{128} << 10;
constexpr size_t kBlocksBytes = size_t{4} << 20;

}  // namespace

CueTable::CueTable(const VariedContacts& contacts, std::vector<Cue> cues,
                   const Options& options)
    : contacts_(&contacts), cues_(std::move(cues)), options_(options) {
  for (const LabelledContact* contact : contacts.originals()) {
    most_steps_.push_back(CountSteps(*contact, options.steps));
  }
}

void CueTable::Walk(
    const ParallelFor& parallel,
    absl::FunctionRef<void(std::span<const double> values)> visit) {
  size_t bytes = 0;
  for (size_t i = 0; i < contacts_->size(); ++i) bytes += MostBytes(i);
  const bool keeps = bytes <= options_.kept_bytes;
  values_.clear();
  begins_.clear();
  if (keeps) {
    values_.reserve(bytes / sizeof(double));
    begins_.push_back(0);
  }
  for (size_t begin = 0; begin < contacts_->size();) {
    std::vector<Block> blocks = NextBlocks(begin);
    parallel(static_cast<int>(blocks.size()), [&](int b) { Fill(blocks[b]); });
    for (const Block& block : blocks) {
      for (size_t at = 0; at < block.values.size(); at += cues_.size()) {
        visit(std::span(block.values).subspan(at, cues_.size()));
      }
      if (keeps) Keep(block);
    }
    begin = blocks.back().end;
  }
}

std::vector<CueTable::Block> CueTable::NextBlocks(size_t begin) const {
  std::vector<Block> blocks;
  size_t all_bytes = 0;
  size_t bytes = kBlockBytes;
  for (size_t i = begin; i < contacts_->size() && all_bytes < kBlocksBytes;
       ++i) {
    if (bytes >= kBlockBytes) {
      blocks.push_back({.begin = i});
      bytes = 0;
    }
    bytes += MostBytes(i);
    all_bytes += MostBytes(i);
    blocks.back().end = i + 1;
  }
  return blocks;
}

void CueTable::Fill(Block& block) const {
  CueGroups groups = 0;
  for (const Cue cue : cues_) groups |= GroupOf(cue);
  size_t bytes = 0;
  for (size_t i = block.begin; i < block.end; ++i) bytes += MostBytes(i);
  block.values.reserve(bytes / sizeof(double));
  LabelledContact made;
  for (size_t i = block.begin; i < block.end; ++i) {
    size_t steps = 0;
    WalkCues(contacts_->Get(i, made), options_.steps, groups,
             options_.embedding, [&](CueTracker& tracker, size_t) {
               for (const Cue cue : cues_) {
                 block.values.push_back(tracker.value(cue));
               }
               ++steps;
             });
    block.steps.push_back(steps);
  }
}

void CueTable::Keep(const Block& block) {
  values_.insert(values_.end(), block.values.begin(), block.values.end());
  for (const size_t steps : block.steps) {
    begins_.push_back(begins_.back() + steps);
  }
}

}  // namespace tactus::internal
