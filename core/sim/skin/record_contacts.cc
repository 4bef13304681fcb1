#include "core/sim/skin/record_contacts.h"

#include <algorithm>
#include <cmath>

#include "core/base/gaussian.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/line_contact.h"
#include "core/sim/skin/taxel_kernels.h"

namespace tactus::internal {
namespace {

// The electronics behind each taxel.
class TaxelReader {
 public:
  TaxelReader(const SkinModel& skin, Random& random, TaxelSeries& series)
      : skin_(skin),
        random_(random),
        series_(series),
        electronics_{.noise_n = skin.noise_n,
                     .lagging = skin.lagging,
                     .follow = Follow(skin)},
        alive_(skin.layout.taxels(), 1),
        offset_(skin.layout.taxels()),
        lagging_(skin.layout.taxels()),
        deviates_(skin.layout.taxels()),
        readings_(skin.layout.taxels()),
        steps_(skin.layout.taxels()) {
    const size_t taxels = alive_.size();
    for (int left = skin.dead_taxels; left > 0;) {
      double& taxel = alive_[random.Index(taxels)];
      left -= taxel > 0;
      taxel = 0;
    }
    for (int i = 0; i < skin.stray_taxels; ++i) {
      offset_[random.Index(taxels)] =
          random.Uniform(skin.stray_min_n, skin.stray_max_n);
    }
  }

  // Appends a frame of these forces, N on each taxel.
  void Read(const std::vector<double>& forces) {
    if (skin_.drift_n > 0) {
      FillGaussian(random_, deviates_);
      const double step = skin_.drift_n / std::sqrt(kSkinRateHz);
      for (size_t i = 0; i < offset_.size(); ++i) {
        offset_[i] += step * deviates_[i];
      }
    }
    FillGaussian(random_, deviates_);
    taxel_kernels::Read(forces, electronics_,
                        {.alive = alive_.data(),
                         .offset = offset_.data(),
                         .deviates = deviates_.data(),
                         .lagging = lagging_.data()},
                        readings_.data());
    if (skin_.step_n == 0) {
      series_.f32.insert(series_.f32.end(), readings_.begin(), readings_.end());
      return;
    }
    taxel_kernels::Quantise(readings_, skin_.step_n, steps_.data());
    series_.u16.insert(series_.u16.end(), steps_.begin(), steps_.end());
  }

 private:
  static double Follow(const SkinModel& skin) {
    return skin.lagging > 0 ? 1 - std::exp(-1 / (kSkinRateHz * skin.lag_s)) : 0;
  }

  const SkinModel& skin_;
  Random& random_;
  TaxelSeries& series_;
  const taxel_kernels::Electronics electronics_;
  // 1, or 0 for a dead taxel.
  std::vector<double> alive_;
  std::vector<double> offset_;
  // The forces, delayed.
  std::vector<double> lagging_;
  std::vector<double> deviates_;
  // The last frame, N and in steps.
  std::vector<double> readings_;
  std::vector<uint16_t> steps_;
};

// One object's face, pressed as its contact says.
class PressingFace {
 public:
  PressingFace(const PlacedContact& placed, const SkinModel& skin)
      : placed_(placed),
        object_(placed.contact->spec.object),
        bedding_(Bedding(object_.material.youngs_modulus, object_.edge_m,
                         skin.cover_n_m3)),
        face_(skin.layout, placed.centre) {}

  // Adds what the face presses at `frame`, N on each taxel.
  void AddLoad(size_t frame, std::vector<double>& loads) {
    double force = 0;
    if (frame >= placed_.begin_frame + placed_.begin_sample &&
        frame < placed_.begin_frame + placed_.end_sample) {
      const FeatureVector& sample =
          placed_.contact->signals.samples[frame - placed_.begin_frame];
      force = std::max(sample[static_cast<int>(Feature::kForce)], 0.0);
    }
    if (force == 0) return;
    face_.Press(force, {.edge_m = std::sqrt(ContactArea(object_, force)),
                        .bedding_n_m3 = bedding_,
                        .tilt_rad = placed_.tilt_rad});
    for (size_t i = 0; i < loads.size(); ++i) loads[i] += face_.taxels()[i];
  }

 private:
  const PlacedContact& placed_;
  const Cube& object_;
  const double bedding_;
  LineContact face_;
};

}  // namespace

Trial RecordContacts(const Trial& metadata,
                     std::span<const PlacedContact> contacts,
                     const SkinModel& skin, const LinkMotion& motion,
                     Random& random) {
  Trial trial = metadata;
  SetSkin(skin.layout, trial);
  trial.taxels.rows = skin.layout.rows;
  trial.taxels.columns = skin.layout.columns;
  if (skin.step_n > 0) trial.taxels.scale = skin.step_n;
  const size_t frames = motion.steps.size();
  const size_t readings = frames * skin.layout.taxels();
  (skin.step_n > 0 ? trial.taxels.u16.reserve(readings)
                   : trial.taxels.f32.reserve(readings));
  trial.time.reserve(frames);
  trial.poses.reserve(frames);
  std::vector<PressingFace> faces;
  faces.reserve(contacts.size());
  for (const PlacedContact& contact : contacts) {
    faces.emplace_back(contact, skin);
  }
  TaxelReader reader(skin, random, trial.taxels);
  std::vector<double> loads(skin.layout.taxels());
  for (size_t i = 0; i < frames; ++i) {
    std::fill(loads.begin(), loads.end(), 0);
    for (PressingFace& face : faces) face.AddLoad(i, loads);
    reader.Read(loads);
    Pose pose;
    for (double& coordinate : pose.position) {
      coordinate = motion.pose_noise_m * random.Gaussian();
    }
    const LinkStep& step = motion.steps[i];
    pose.position +=
        step.direction * (step.distance_m * (1 + motion.pose_gain_error));
    trial.poses.push_back(pose);
    trial.time.push_back(static_cast<double>(i) / kSkinRateHz);
  }
  return trial;
}

}  // namespace tactus::internal
