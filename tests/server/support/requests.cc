#include "tests/server/support/requests.h"

#include <cmath>
#include <cstring>

#include "core/base/random.h"

namespace tactus::internal::testing {
namespace {

template <typename Type>
void Append(Type value, std::string* bytes) {
  char buffer[sizeof(value)];
  std::memcpy(buffer, &value, sizeof(value));
  bytes->append(buffer, sizeof(value));
}

v1::FrameBatch* StartBatch(uint64_t sequence, size_t frames,
                           v1::ClassifyContactRequest* request) {
  v1::FrameBatch* batch = request->mutable_frames();
  batch->set_first_sequence(sequence);
  batch->set_first_capture_time_ns(static_cast<int64_t>(sequence) * 10'000'000);
  batch->set_frame_count(static_cast<uint32_t>(frames));
  return batch;
}

template <typename Type>
v1::ClassifyContactRequest Dense(uint64_t sequence,
                                 const std::vector<Counts>& frames,
                                 Type (*convert)(uint16_t)) {
  v1::ClassifyContactRequest request;
  v1::FrameBatch* batch = StartBatch(sequence, frames.size(), &request);
  for (const Counts& frame : frames) {
    for (uint16_t count : frame) {
      Append(convert(count), batch->mutable_taxels());
    }
  }
  return request;
}

template <typename Type>
v1::ClassifyContactRequest Sparse(uint64_t sequence,
                                  const std::vector<Counts>& frames,
                                  Type (*convert)(uint16_t)) {
  v1::ClassifyContactRequest request;
  v1::FrameBatch* batch = StartBatch(sequence, frames.size(), &request);
  v1::SparseFrames* sparse = batch->mutable_sparse();
  for (const Counts& frame : frames) {
    uint32_t touched = 0;
    for (size_t i = 0; i < frame.size(); ++i) {
      if (frame[i] == 0) continue;
      ++touched;
      Append(static_cast<uint16_t>(i), sparse->mutable_indices());
      Append(convert(frame[i]), sparse->mutable_values());
    }
    sparse->add_counts(touched);
  }
  return request;
}

uint16_t AsU16(uint16_t count) { return count; }
float AsNewton(uint16_t count) { return static_cast<float>(count * kStep); }

}  // namespace

v1::ClassifyContactRequest ConfigRequest(const std::string& model) {
  v1::ClassifyContactRequest request;
  v1::StreamConfig* config = request.mutable_config();
  config->set_model(model);
  config->mutable_geometry()->set_layout("cody-forearm");
  config->set_taxel_type(v1::TAXEL_TYPE_UINT16);
  config->set_scale(kStep);
  config->set_never_release(true);
  return request;
}

v1::ClassifyContactRequest EndOfTrialRequest() {
  v1::ClassifyContactRequest request;
  request.mutable_end_of_trial();
  return request;
}

Counts Untouched() { return Counts(kCodyTaxels, 0); }

Counts Touch(double newton, int taxels) {
  Counts counts = Untouched();
  for (int i = 0; i < taxels; ++i) {
    counts[5 * 24 + 7 + i] = static_cast<uint16_t>(std::lround(newton / kStep));
  }
  return counts;
}

std::vector<Counts> Contact(int frames, uint64_t seed) {
  Random random(seed);
  const int untouched = static_cast<int>(random.Index(5));
  const double rate = random.Uniform(0.01, 0.2);
  const int column = static_cast<int>(random.Index(24));
  const double speed = random.Uniform(0, 0.3);
  std::vector<Counts> result;
  for (int t = 0; t < frames; ++t) {
    result.push_back(Untouched());
    if (t < untouched) continue;
    for (int row = 4; row < 7; ++row) {
      for (int k = 0; k < 3; ++k) {
        const int at = (column + k + static_cast<int>(t * speed)) % 24;
        const double newton = rate * (t - untouched + 1) + random.Uniform();
        result.back()[row * 24 + at] =
            static_cast<uint16_t>(std::lround(newton / kStep));
      }
    }
  }
  return result;
}

v1::ClassifyContactRequest DenseU16(uint64_t sequence,
                                    const std::vector<Counts>& frames) {
  return Dense<uint16_t>(sequence, frames, AsU16);
}

v1::ClassifyContactRequest DenseF32(uint64_t sequence,
                                    const std::vector<Counts>& frames) {
  return Dense<float>(sequence, frames, AsNewton);
}

v1::ClassifyContactRequest SparseU16(uint64_t sequence,
                                     const std::vector<Counts>& frames) {
  return Sparse<uint16_t>(sequence, frames, AsU16);
}

v1::ClassifyContactRequest SparseF32(uint64_t sequence,
                                     const std::vector<Counts>& frames) {
  return Sparse<float>(sequence, frames, AsNewton);
}

void AddPose(const Pose& pose, v1::FrameBatch* batch) {
  for (double value : pose.position) batch->add_poses(value);
  batch->add_poses(pose.orientation.x());
  batch->add_poses(pose.orientation.y());
  batch->add_poses(pose.orientation.z());
  batch->add_poses(pose.orientation.w());
}

std::vector<float> Newtons(const Counts& counts) {
  std::vector<float> values;
  for (uint16_t count : counts) values.push_back(AsNewton(count));
  return values;
}

}  // namespace tactus::internal::testing
