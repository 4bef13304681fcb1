#include "core/lstm/batch_gradient.h"

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/lstm/tensors.h"

namespace tactus::internal {
namespace {

template <typename T>
void Append(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// What a shard gives: its loss, and its gradient times its share of the batch.
void AppendShard(const LstmBatchLoss& loss, LstmNetwork& gradient, float share,
                 std::string& bytes) {
  Append(loss.sum, bytes);
  Append(loss.correct, bytes);
  ForEachTensor(gradient, [&](std::vector<float>& weights, bool) {
    for (float& weight : weights) weight *= share;
    bytes.append(reinterpret_cast<const char*>(weights.data()),
                 weights.size() * sizeof(float));
  });
}

// Reads such bytes one after another.
class Shards {
 public:
  explicit Shards(const std::string& bytes) : bytes_(bytes) {}

  bool Has(size_t size) const { return bytes_.size() - at_ >= size; }
  void AddLoss(LstmBatchLoss& loss) {
    double sum = 0;
    int correct = 0;
    Take(sum);
    Take(correct);
    loss.sum += sum;
    loss.correct += correct;
  }
  void AddGradient(LstmNetwork& gradient) {
    ForEachTensor(gradient, [&](std::vector<float>& weights, bool) {
      for (float& weight : weights) {
        float more = 0;
        Take(more);
        weight += more;
      }
    });
  }

 private:
  template <typename T>
  void Take(T& value) {
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
  }

  const std::string& bytes_;
  size_t at_ = 0;
};

}  // namespace

BatchGradient::BatchGradient(const LstmNetwork& network,
                             LstmSequenceSource& training,
                             const LstmTrainOptions& options, Ranks& ranks)
    : training_(training),
      options_(options),
      ranks_(ranks),
      backprop_(network) {}

absl::StatusOr<LstmBatchLoss> BatchGradient::Compute(
    const LstmNetwork& network, std::span<const size_t> numbers, uint64_t step,
    LstmNetwork& gradient) {
  backprop_.SetWeights(network);
  const size_t shards = std::min<size_t>(options_.shards, numbers.size());
  if (options_.shards == 1) return ComputeShard(numbers, step, gradient);
  return ComputeShards(numbers, shards, step, gradient);
}

LstmBatchLoss BatchGradient::ComputeShard(std::span<const size_t> numbers,
                                          uint64_t stream,
                                          LstmNetwork& gradient) {
  training_.Get(numbers, batch_);
  // Even streams shuffle the epochs.
  Random random = Random::ForStream(options_.seed, 2 * stream + 1);
  backprop_.Forward(batch_, options_.noise, random);
  const LstmBatchLoss loss = backprop_.Loss(options_.loss);
  backprop_.Backward(gradient);
  return loss;
}

absl::StatusOr<LstmBatchLoss> BatchGradient::ComputeShards(
    std::span<const size_t> numbers, size_t shards, uint64_t step,
    LstmNetwork& gradient) {
  const auto begin_of = [&](size_t s) { return s * numbers.size() / shards; };
  const auto ranks = static_cast<size_t>(ranks_.size());
  mine_.clear();
  for (auto s = static_cast<size_t>(ranks_.rank()); s < shards; s += ranks) {
    const auto shard =
        numbers.subspan(begin_of(s), begin_of(s + 1) - begin_of(s));
    const LstmBatchLoss loss = ComputeShard(
        shard, step * static_cast<uint64_t>(options_.shards) + s, gradient);
    AppendShard(
        loss, gradient,
        static_cast<float>(shard.size()) / static_cast<float>(numbers.size()),
        mine_);
  }
  TACTUS_ASSIGN_OR_RETURN(const auto all, ranks_.Exchange(mine_));
  ForEachTensor(gradient, [](std::vector<float>& weights, bool) {
    std::ranges::fill(weights, 0.0F);
  });
  const size_t size =
      sizeof(double) + sizeof(int) +
      static_cast<size_t>(gradient.parameter_count()) * sizeof(float);
  std::vector<Shards> of_rank(all.begin(), all.end());
  LstmBatchLoss total;
  for (size_t s = 0; s < shards; ++s) {
    Shards& from = of_rank[s % ranks];
    if (!from.Has(size)) {
      return CheckpointInvalid(absl::StrCat("shard ", s),
                               "its rank has not sent it");
    }
    from.AddLoss(total);
    from.AddGradient(gradient);
  }
  return total;
}

}  // namespace tactus::internal
