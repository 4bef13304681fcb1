// File: contact_pipeline.h
//
// ContactPipeline: takes skin frames and returns the contacts with their
// running classes. It is the whole per-frame path of Tactus. The server's
// streams, trainctl and the tests all run this class, so their numbers are
// equal bit for bit.
//
//   auto pipeline = ContactPipeline::Create(layout, model, {});
//   for (const FrameView& frame : frames) {
//     for (const ContactReport& contact : (*pipeline)->Step(frame)) {
//       Use(contact.id, contact.classifier->best_class());
//     }
//   }
//   (*pipeline)->EndTrial();
//
// Work that a frame does not need is skipped (skip_rules.h). Step() locks
// nothing, and allocates only when there are more contacts at once than there
// ever were. Not thread-safe: one per stream.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "absl/status/statusor.h"
#include "core/base/limits.h"
#include "core/classify/contact_classifier.h"
#include "core/features/skin_tracker.h"
#include "core/skin/frame.h"

namespace tactus::internal {

// A contact after a frame.
struct ContactReport {
  // Counts the contacts of a stream from 1.
  uint64_t id = 0;
  // Its place in the tracker (TrackedContact::slot).
  int slot = 0;
  TouchPhase phase = TouchPhase::kInContact;
  // True if this frame began the contact.
  bool onset = false;
  // The contact of whose region it was a part, and the one that it is merged
  // into; 0 if none.
  uint64_t parent = 0;
  uint64_t merged_into = 0;
  // False while light touch feels only what is left of an earlier load, which
  // says nothing of where the contact is (ContactTrack::unfelt).
  bool felt = true;
  // Valid until the next Step().
  const FrameFeatures* features = nullptr;
  // Its scores; after its end the last ones. They rest while touch is lost and
  // while it is merged. Valid until a later contact takes its place.
  const ContactClassifier* classifier = nullptr;

  bool released() const { return phase == TouchPhase::kReleased; }
};

class ContactPipeline {
 public:
  struct Options {
    double sample_rate_hz = 100;
    // Seconds without touch that end a contact. If negative, only EndTrial()
    // ends it. Zero selects the model's value.
    double release_after_s = 0;
    // Contacts that are followed at the same time, at most
    // limits::kMaxContacts. With 1, all that touches the skin is one contact.
    // Zero: 1 if the model sees the load on the whole skin, which no region can
    // be told from, or if contacts do not end with their touch; else the limit.
    int max_contacts = 0;
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

  // Takes the next frame. Returns the contacts that there are, and those that
  // ended with this frame: the one with the largest area first.
  std::span<const ContactReport> Step(const FrameView& frame);

  // The contacts of the last frame. After EndTrial() none.
  std::span<const ContactReport> contacts() const {
    return {reports_.data(), count_};
  }
  // The contact that a robot reads if it wants one: the largest of the last
  // frame that has not ended; if there is none, the last that ended. Null
  // before the first contact of a trial.
  const ContactReport* main_contact() const;

  // Forgets the trial. Contact ids continue.
  void EndTrial();

  // Where the contacts are.
  SkinTracker& tracker() { return tracker_; }
  // Contacts so far, over all trials.
  uint64_t contacts_begun() const { return tracker_.contacts_begun(); }
  int max_contacts() const { return max_contacts_; }
  // Counts of skipped work over all trials.
  SkipCounters skipped() const;

 private:
  ContactClassifier& ClassifierOf(int slot);
  void Report(const TrackedContact& contact, const FrameView& frame,
              ContactReport& report);
  void CountSkipped();

  const std::shared_ptr<const CompiledModel> model_;
  const Options options_;
  const bool uses_poses_;
  const int max_contacts_;
  // One for each of the tracker's slots, made when it is first needed; the
  // first at once.
  std::array<std::unique_ptr<ContactClassifier>, limits::kMaxContacts>
      classifiers_;
  SkinTracker tracker_;
  std::array<ContactReport, limits::kMaxContacts> reports_;
  size_t count_ = 0;
  // The last contact of this trial that ended; its features are 0.
  ContactReport ended_;
  FrameFeatures no_features_;
  // Counters of the tracker.
  SkipCounters skipped_;
};

// How many contacts a pipeline follows at the same time.
int MostContacts(const Model& model, const ContactPipeline::Options& options);

}  // namespace tactus::internal
