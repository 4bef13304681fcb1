#include "core/sim/skin/render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/features/contact_tracker.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/patch.h"

namespace tactus {
namespace {

// Noise and place come from another stream than the signals' noise.
constexpr uint64_t kRenderStream = uint64_t{1} << 32;

constexpr double kLargestReading = std::numeric_limits<uint16_t>::max();

absl::Status CheckRange(absl::string_view field, double value, double low,
                        double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return InvalidScene(field, value, absl::StrCat(low, " to ", high));
}

// One byte a taxel, 0 = dead.
std::vector<uint8_t> AliveTaxels(const RenderOptions& options, int taxels) {
  std::vector<uint8_t> alive(taxels, 1);
  for (int taxel : options.dead_taxels) alive[taxel] = 0;
  Random random(options.dead_seed);
  for (int left = options.dead_count; left > 0;) {
    uint8_t& taxel = alive[random.Index(taxels)];
    left -= taxel;
    taxel = 0;
  }
  return alive;
}

SkinPoint DrawCentre(const SkinLayout& layout, Random& random) {
  SkinPoint centre;
  centre.row = random.Uniform(0, layout.rows - 1);
  centre.column = random.Uniform(
      0, layout.wrap_columns ? layout.columns : layout.columns - 1);
  return centre;
}

// Draws the noise of one frame and appends its readings.
class FrameWriter {
 public:
  FrameWriter(const SkinLayout& layout, const RenderOptions& options,
              const SkinPoint& centre, Random& random, TaxelSeries& series)
      : layout_(layout),
        options_(options),
        centre_(centre),
        alive_(AliveTaxels(options, layout.taxels())),
        random_(random),
        series_(series) {}

  // A patch of `area` m^2 presses with `force` N; 0 for no contact.
  void Append(double force, double area) {
    const bool contact = force > 0;
    if (contact) SpreadPatch(layout_, centre_, std::sqrt(area), shares_);
    for (int row = 0; row < layout_.rows; ++row) {
      for (int column = 0; column < layout_.columns; ++column) {
        const double ideal =
            contact ? force * shares_.Of(row, column) * options_.unit_per_newton
                    : 0;
        // Drawn for dead taxels too, so that they change no other reading.
        const double value = ideal + options_.taxel_noise * random_.Gaussian();
        const bool alive = alive_[row * layout_.columns + column] != 0;
        series_.u16.push_back(alive ? Quantise(value) : 0);
      }
    }
  }

 private:
  uint16_t Quantise(double value) const {
    return static_cast<uint16_t>(std::clamp(
        std::round(value / options_.taxel_step), 0.0, kLargestReading));
  }

  const SkinLayout& layout_;
  const RenderOptions& options_;
  const SkinPoint centre_;
  const std::vector<uint8_t> alive_;
  Random& random_;
  TaxelSeries& series_;
  PatchShares shares_;
};

}  // namespace

absl::Status Validate(const RenderOptions& options, const SkinLayout& layout) {
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  if (options.centre) {
    TACTUS_RETURN_IF_ERROR(CheckRange("render.centre.row", options.centre->row,
                                      0, layout.rows - 1));
    TACTUS_RETURN_IF_ERROR(
        CheckRange("render.centre.column", options.centre->column, 0,
                   layout.wrap_columns ? layout.columns : layout.columns - 1));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRange("render.unit_per_newton", options.unit_per_newton, 1e-9, 1e9));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("render.taxel_noise", options.taxel_noise, 0, 1e9));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("render.taxel_step", options.taxel_step, 1e-9, 1e6));
  for (int taxel : options.dead_taxels) {
    TACTUS_RETURN_IF_ERROR(
        CheckRange("render.dead_taxels", taxel, 0, layout.taxels() - 1));
  }
  // The named ones may all differ from those drawn.
  const double left =
      layout.taxels() - static_cast<double>(options.dead_taxels.size());
  TACTUS_RETURN_IF_ERROR(CheckRange("render.dead_count", options.dead_count, 0,
                                    std::max(0.0, left)));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("render.encoder_noise_m", options.encoder_noise_m, 0, 1));
  return CheckRange("render.lead_in_frames", options.lead_in_frames, 0,
                    limits::kMaxLeadInFrames);
}

absl::StatusOr<Trial> TaxelTrial(const SimulatedContact& contact,
                                 const SkinLayout& layout,
                                 const RenderOptions& options, uint64_t seed) {
  TACTUS_RETURN_IF_ERROR(Validate(options, layout));
  Random random = Random::ForStream(seed, kRenderStream + contact.spec.number);
  const SkinPoint centre =
      options.centre ? *options.centre : DrawCentre(layout, random);
  const Eigen::Vector3d normal = LinkNormal(layout, centre);

  Trial trial = contact.Metadata();
  SetSkin(layout, trial);
  trial.taxels.rows = layout.rows;
  trial.taxels.columns = layout.columns;
  trial.taxels.scale = options.taxel_step;
  const size_t lead_in = options.lead_in_frames;
  const size_t frames = lead_in + contact.signals.samples.size();
  trial.time.reserve(frames);
  trial.poses.reserve(frames);
  trial.taxels.u16.reserve(frames * layout.taxels());
  FrameWriter writer(layout, options, centre, random, trial.taxels);
  for (size_t i = 0; i < frames; ++i) {
    FeatureVector sample = {0, 0, 0};
    if (i >= lead_in) sample = contact.signals.samples[i - lead_in];
    const double force = sample[static_cast<int>(Feature::kForce)];
    const double motion = sample[static_cast<int>(Feature::kMotion)];
    // The area under this force, not the area signal: averaged over impacts,
    // that one shrinks with the time apart, which a patch does not.
    writer.Append(force, ContactArea(contact.spec.object, force));
    Pose pose;
    pose.position =
        normal * (motion + options.encoder_noise_m * random.Gaussian());
    trial.poses.push_back(pose);
    trial.time.push_back(i / kSkinRateHz);
    // Frame `lead_in - 1` is the touch itself.
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
