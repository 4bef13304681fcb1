#include "core/sim/skin/record_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/gaussian.h"
#include "core/features/contact_tracker.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/line_contact.h"
#include "core/sim/skin/taxel_kernels.h"

namespace tactus {
namespace {

constexpr double kTiltDeviation = 0.5 * std::numbers::pi / 180;

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

}  // namespace

Placement DrawPlacement(const SkinLayout& layout, Random& random) {
  Placement placement;
  placement.centre.row = random.Uniform(0, layout.rows - 1);
  placement.centre.column = random.Uniform(
      0, layout.wrap_columns ? layout.columns : layout.columns - 1);
  placement.tilt_rad = kTiltDeviation * random.Gaussian();
  return placement;
}

Trial RecordContact(const SimulatedContact& contact, const SkinModel& skin,
                    const Placement& placement, Random& random) {
  Trial trial = contact.Metadata();
  SetSkin(skin.layout, trial);
  trial.taxels.rows = skin.layout.rows;
  trial.taxels.columns = skin.layout.columns;
  if (skin.step_n > 0) trial.taxels.scale = skin.step_n;
  const size_t lead_in = placement.lead_in_frames;
  const size_t frames = lead_in + contact.signals.samples.size();
  const size_t readings = frames * skin.layout.taxels();
  (skin.step_n > 0 ? trial.taxels.u16.reserve(readings)
                   : trial.taxels.f32.reserve(readings));
  trial.time.reserve(frames);
  trial.poses.reserve(frames);
  const Eigen::Vector3d normal = LinkNormal(skin.layout, placement.centre);
  const Cube& object = contact.spec.object;
  const ContactScene scene = SceneOf(contact.spec);
  LineContact face(skin.layout, placement.centre);
  TaxelReader reader(skin, random, trial.taxels);
  for (size_t i = 0; i < frames; ++i) {
    FeatureVector sample = {0, 0, 0};
    if (i >= lead_in) {
      sample = contact.signals.samples[i - lead_in];
    } else {
      const double before_s =
          static_cast<double>(lead_in - 1 - i) / kSkinRateHz;
      sample[static_cast<int>(Feature::kMotion)] =
          ApproachPosition(contact.spec.approach_s, before_s, scene);
    }
    const double force = sample[static_cast<int>(Feature::kForce)];
    const double motion = sample[static_cast<int>(Feature::kMotion)];
    face.Press(std::max(force, 0.0),
               {.edge_m = std::sqrt(ContactArea(object, std::max(force, 0.0))),
                .bedding_n_m3 = Bedding(object.material.youngs_modulus,
                                        object.edge_m, skin.cover_n_m3),
                .tilt_rad = placement.tilt_rad});
    reader.Read(face.taxels());
    Pose pose;
    for (double& coordinate : pose.position) {
      coordinate = placement.pose_noise_m * random.Gaussian();
    }
    pose.position += normal * (motion * (1 + placement.pose_gain_error));
    trial.poses.push_back(pose);
    trial.time.push_back(static_cast<double>(i) / kSkinRateHz);
    trial.object_motion.push_back(
        i < lead_in ? 0 : contact.signals.object_motion[i - lead_in]);
  }
  return trial;
}

bool Detectable(const Trial& trial, const SkinLayout& layout) {
  ContactTracker tracker(
      layout, {.sample_rate_hz = trial.sample_rate_hz, .load_profile = false});
  std::vector<float> frame(layout.taxels());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, frame.data());
    tracker.Step({.taxels = frame});
    if (tracker.onset()) return true;
  }
  return false;
}

}  // namespace tactus
