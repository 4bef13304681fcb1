// File: random_streams.h
//
// Random streams of any skin and encoding: objects that come and go, bounce,
// wander, join and part; quiet times of any length, lost frames, and ends of
// trials.
//
//   const RandomStream stream = MakeStream(kind, seed);
//   RunStream(stream, rig);
//
// A function of the seed. Test-only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/skin/layout_proto.h"
#include "core/skin/taxel_values.h"
#include "tests/server/contact_log/recorded_streams.h"
#include "tests/server/support/requests.h"

namespace tactus::internal::server {

struct StreamKind {
  std::string name;
  v1::TaxelType type = v1::TAXEL_TYPE_UINT16;
  bool sparse = false;
  int axes = 1;
  bool light = false;
  bool poses = false;
  double rate_hz = 100;
  // Each message has 1 to this many frames, or always this many.
  uint32_t batch = 8;
  bool same_batches = false;
  // Share of messages before which frames are lost.
  double loss = 0;
  int frames = 1500;
};

struct RandomStream {
  struct Step {
    bool end_of_trial = false;
    v1::FrameBatch batch;
  };
  v1::StreamConfig config;
  std::vector<Step> steps;
};

namespace random_stream {

struct Object {
  double row = 0;
  double column = 0;
  double speed = 0;
  double newton = 0;
  int from = 0;
  int until = 0;
  // Frames between bounces of one frame or more.
  int bounce = 0;
};

inline SkinLayout Skin(const StreamKind& kind) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "random";
  if (kind.axes == 3) {
    layout.axes = 3;
    layout.normal_axis = 1;
  }
  layout.signed_values = kind.type == v1::TAXEL_TYPE_INT16;
  if (kind.light) {
    layout.light_touch = {.window_s = 0.1,
                          .rows = 3,
                          .columns = 3,
                          .contact_threshold = 0.02,
                          .onset_threshold = 0.03};
  }
  return layout;
}

// What a robot may ask for, most of it in some streams only.
inline void SetOptions(uint64_t seed, v1::StreamConfig& config) {
  Random random = Random::ForStream(seed, 1);
  config.set_with_taxels(random.Uniform() < 0.3);
  config.set_with_diagnostics(random.Uniform() < 0.7);
  if (random.Uniform() < 0.2) config.set_effort(v1::EFFORT_LOW);
  if (random.Uniform() < 0.3) {
    config.set_max_contacts(1 + static_cast<uint32_t>(random.Index(3)));
  }
  if (random.Uniform() < 0.3) {
    config.set_release_after_ms(30 + static_cast<uint32_t>(random.Index(1500)));
  }
}

inline std::vector<Object> Objects(const StreamKind& kind, Random& random) {
  std::vector<Object> objects;
  // Frames in 10 ms.
  const double pace = kind.rate_hz / 100;
  int at = 0;
  while (at < kind.frames) {
    // Touches follow soon, at once, or after seconds.
    const double gap = random.Uniform();
    at += static_cast<int>(pace * random.Uniform(0, gap < 0.3   ? 10
                                                    : gap < 0.7 ? 80
                                                                : 300));
    Object object;
    object.row = static_cast<double>(random.Index(14));
    object.column = random.Uniform(0, 24);
    object.speed = random.Uniform() < 0.5 ? random.Uniform(-0.4, 0.4) : 0;
    object.newton = std::exp(random.Uniform(-3, 1));
    object.from = at;
    object.until = at + 2 + static_cast<int>(pace * random.Uniform(0, 120));
    object.bounce =
        random.Uniform() < 0.3 ? 2 + static_cast<int>(random.Index(40)) : 0;
    // The next may come while this one presses.
    at = random.Uniform() < 0.4 ? at + 1 : object.until;
    objects.push_back(object);
  }
  return objects;
}

// The loads of a frame in steps of testing::kStep.
inline std::vector<double> Loads(const std::vector<Object>& objects, int t,
                                 double noise, Random& random) {
  std::vector<double> loads(testing::kCodyTaxels);
  for (const Object& object : objects) {
    if (t < object.from || t >= object.until) continue;
    const int age = t - object.from;
    if (object.bounce > 0 && age % object.bounce == object.bounce - 1) continue;
    const int column =
        static_cast<int>(std::floor(object.column + object.speed * age));
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 3; ++c) {
        const int row = static_cast<int>(object.row) + r;
        const int place = row * 24 + ((column + c) % 24 + 24) % 24;
        loads[place] += object.newton * random.Uniform(0.5, 1.5);
      }
    }
  }
  for (double& load : loads) {
    if (noise > 0) load += noise * std::abs(random.Gaussian());
    load = std::min(std::round(load / testing::kStep), 32'000.0);
  }
  return loads;
}

template <typename Number>
void Append(Number number, std::string& bytes) {
  char buffer[sizeof number];
  std::memcpy(buffer, &number, sizeof number);
  bytes.append(buffer, sizeof number);
}

inline void AppendValue(v1::TaxelType type, double count, std::string& bytes) {
  if (type == v1::TAXEL_TYPE_FLOAT32) {
    Append(static_cast<float>(count * testing::kStep), bytes);
  } else if (type == v1::TAXEL_TYPE_INT16) {
    Append(static_cast<int16_t>(count), bytes);
  } else {
    Append(static_cast<uint16_t>(count), bytes);
  }
}

inline void AddFrame(const StreamKind& kind, const std::vector<double>& loads,
                     Random& random, v1::FrameBatch& batch) {
  std::vector<double> values;
  for (const double load : loads) {
    if (kind.axes == 3) values.push_back(std::round(50 * random.Uniform()));
    values.push_back(load);
    if (kind.axes == 3) values.push_back(std::round(0.1 * load));
  }
  batch.set_frame_count(batch.frame_count() + 1);
  if (!kind.sparse) {
    for (const double value : values) {
      AppendValue(kind.type, value, *batch.mutable_taxels());
    }
    return;
  }
  uint32_t count = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i] == 0) continue;
    Append(static_cast<uint16_t>(i),
           *batch.mutable_sparse()->mutable_indices());
    AppendValue(kind.type, values[i],
                *batch.mutable_sparse()->mutable_values());
    ++count;
  }
  batch.mutable_sparse()->add_counts(count);
}

inline Pose PoseAt(int t, double rate_hz, Random& random) {
  Pose pose;
  const double s = t / rate_hz;
  pose.position = {0.3 * std::sin(s), 0.1 * std::cos(2 * s),
                   0.5 + 1e-3 * random.Gaussian()};
  pose.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * s, Eigen::Vector3d::UnitX()));
  return pose;
}

}  // namespace random_stream

inline RandomStream MakeStream(const StreamKind& kind, uint64_t seed) {
  Random random(seed);
  RandomStream stream;
  v1::StreamConfig& config = stream.config;
  *config.mutable_geometry() = LayoutToProto(random_stream::Skin(kind));
  config.set_taxel_type(kind.type);
  config.set_client_id("robot " + kind.name);
  config.set_sample_rate_hz(kind.rate_hz);
  config.set_with_poses(kind.poses);
  if (kind.type != v1::TAXEL_TYPE_FLOAT32) config.set_scale(testing::kStep);
  random_stream::SetOptions(seed, config);
  const auto objects = random_stream::Objects(kind, random);
  const size_t frame_bytes =
      kind.sparse ? 0
                  : testing::kCodyTaxels * kind.axes * TaxelBytes(kind.type);
  const uint32_t most =
      frame_bytes == 0 ? std::min(kind.batch, kind.axes == 3 ? 24U : 64U)
                       : std::min<uint32_t>(kind.batch, 60'000 / frame_bytes);
  uint64_t sequence = 1 + random.Index(1000);
  int t = 0;
  while (t < kind.frames) {
    if (random.Uniform() < kind.loss) {
      const int lost =
          1 + static_cast<int>(random.Index(random.Uniform() < 0.2 ? 100 : 10));
      sequence += lost;
      t += lost;
    }
    v1::FrameBatch& batch = stream.steps.emplace_back().batch;
    batch.set_first_sequence(sequence);
    batch.set_first_capture_time_ns(
        std::llround(static_cast<double>(sequence) * 1e9 / kind.rate_hz));
    const uint32_t count = kind.same_batches
                               ? most
                               : 1 + static_cast<uint32_t>(random.Index(most));
    for (uint32_t i = 0; i < count; ++i, ++t, ++sequence) {
      const double noise = kind.light ? 0.005 : 0;
      random_stream::AddFrame(
          kind, random_stream::Loads(objects, t, noise, random), random, batch);
      if (!kind.poses) continue;
      testing::AddPose(random_stream::PoseAt(t, kind.rate_hz, random), &batch);
    }
    // About every four seconds.
    if (random.Uniform() < count / (4 * kind.rate_hz)) {
      stream.steps.emplace_back().end_of_trial = true;
    }
  }
  return stream;
}

inline void RunStream(const RandomStream& stream, RecordedStreamRig& rig) {
  for (const RandomStream::Step& step : stream.steps) {
    if (step.end_of_trial) {
      rig.EndTrial();
    } else {
      rig.Send(step.batch);
    }
    if (::testing::Test::HasFatalFailure()) return;
  }
  rig.EndStream();
}

}  // namespace tactus::internal::server
