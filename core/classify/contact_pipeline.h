// File: contact_pipeline.h
//
// ContactPipeline: skin frames in, running contact classes out. The whole
// per-frame path of Tactus; the server's streams, trainctl and the tests all
// run this one class, so their numbers are equal bit for bit.
//
//   auto pipeline = ContactPipeline::Create(layout, model, {});
//   for (const FrameView& frame : frames) {
//     const ContactReport& report = (*pipeline)->Step(frame);
//   }
//   (*pipeline)->EndTrial();
//
// What a frame does not need is skipped (skip_rules.h). Step allocates nothing,
// locks nothing. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/classify/contact_classifier.h"
#include "core/features/contact_tracker.h"
#include "core/skin/frame.h"

namespace tactus {

// What is known after a frame. Class scores are in the classifier.
struct ContactReport {
  ContactState state = ContactState::kNoContact;
  // Counts contacts from 1; 0 before the first.
  uint64_t contact_id = 0;
  // This frame began or ended a contact, or brought the decision.
  bool onset = false;
  bool released = false;
  bool decided = false;
  FrameFeatures features;
};

class ContactPipeline {
 public:
  struct Options {
    double sample_rate_hz = 100;
    // Seconds without touch that end a contact; negative: only EndTrial does.
    double release_after_s = 0.5;
    ContactClassifier::Options decision;
    SkipRules skip;
  };

  // INVALID_CONFIG for a layout or rate out of range or a rate more than 5 %
  // off the model's; GEOMETRY_MISMATCH if the model is of another skin.
  static absl::StatusOr<std::unique_ptr<ContactPipeline>> Create(
      const SkinLayout& layout, std::shared_ptr<const CompiledModel> model,
      const Options& options);

  const ContactReport& Step(const FrameView& frame);

  // Forgets the trial; contact ids go on counting.
  void EndTrial();

  const ContactReport& report() const { return report_; }
  // What was left out so far, in all trials.
  SkipCounters skipped() const;
  // Scores of the current contact; of the last one after its release.
  const ContactClassifier& classifier() const { return classifier_; }

 private:
  ContactPipeline(const SkinLayout& layout,
                  std::shared_ptr<const CompiledModel> model,
                  const Options& options);
  void CountSkipped();

  ContactClassifier classifier_;
  ContactTracker tracker_;
  ContactReport report_;
  SkipRules skip_;
  // Of the tracker.
  SkipCounters skipped_;
};

}  // namespace tactus
