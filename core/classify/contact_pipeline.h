// File: contact_pipeline.h
//
// ContactPipeline: takes skin frames and returns running contact classes. It is
// the whole per-frame path of Tactus. The server's streams, trainctl and the
// tests all run this class, so their numbers are equal bit for bit.
//
//   auto pipeline = ContactPipeline::Create(layout, model, {});
//   for (const FrameView& frame : frames) {
//     const ContactReport& report = (*pipeline)->Step(frame);
//   }
//   (*pipeline)->EndTrial();
//
// Work that a frame does not need is skipped (skip_rules.h). Step() allocates
// nothing and locks nothing. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/classify/contact_classifier.h"
#include "core/features/contact_tracker.h"
#include "core/skin/frame.h"

namespace tactus {

// The state after a frame. The class scores are in the classifier.
struct ContactReport {
  ContactState state = ContactState::kNoContact;
  // Counts contacts from 1; 0 before the first.
  uint64_t contact_id = 0;
  // True if this frame began a contact, ended it, or led to the decision.
  bool onset = false;
  bool released = false;
  bool decided = false;
  FrameFeatures features;
};

class ContactPipeline {
 public:
  struct Options {
    double sample_rate_hz = 100;
    // Seconds without touch that end a contact. If negative, only EndTrial()
    // ends it. Zero selects the model's value.
    double release_after_s = 0;
    // Frames come with poses.
    bool with_poses = true;
    ContactClassifier::Options decision;
    SkipRules skip;
  };

  // OK if Create would succeed. INVALID_CONFIG if the layout or the rate is out
  // of range, if the rate differs from the model's by more than 5 %, or if the
  // model needs poses and frames have none; GEOMETRY_MISMATCH if the model was
  // trained on other skins (SkinMisfit).
  static absl::Status Check(const SkinLayout& layout,
                            const CompiledModel& model, const Options& options);

  // For what Check has accepted.
  ContactPipeline(const SkinLayout& layout,
                  const std::shared_ptr<const CompiledModel>& model,
                  const Options& options);
  // Checks first; the errors are those of Check.
  static absl::StatusOr<std::unique_ptr<ContactPipeline>> Create(
      const SkinLayout& layout,
      const std::shared_ptr<const CompiledModel>& model,
      const Options& options);

  const ContactReport& Step(const FrameView& frame);

  // Forgets the trial. Contact ids continue.
  void EndTrial();

  const ContactReport& report() const { return report_; }
  // Counts of skipped work over all trials.
  SkipCounters skipped() const;
  // Scores of the current contact; after its release, of the last one.
  const ContactClassifier& classifier() const { return classifier_; }

 private:
  void CountSkipped();

  const bool uses_poses_;
  ContactClassifier classifier_;
  ContactTracker tracker_;
  ContactReport report_;
  SkipRules skip_;
  // Counters of the tracker.
  SkipCounters skipped_;
};

}  // namespace tactus
