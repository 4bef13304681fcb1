// File: posterior_writer.h
//
// PosteriorWriter: writes what the pipeline knows after a frame into a
// Posterior, and remembers what the pipeline does not: sequence numbers and
// capture times of onset and decision.
//
// Allocates nothing once its messages have grown. Not thread-safe.
#pragma once

#include <cstdint>

#include "core/classify/contact_pipeline.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::server {

class PosteriorWriter {
 public:
  explicit PosteriorWriter(bool with_features)
      : with_features_(with_features) {}

  // Takes note of the frame that gave `report`; `missing_before` frames were
  // lost directly before it.
  void OnFrame(const ContactReport& report, uint64_t sequence,
               int64_t capture_time_ns, uint64_t missing_before);
  // Forgets the trial.
  void OnEndOfTrial();

  // Overwrites all of `posterior` but server_compute_ns, queue_ns and
  // superseded.
  void Write(const ContactPipeline& pipeline, bool is_final,
             v1::Posterior* posterior) const;

 private:
  void WriteDecision(const ContactPipeline& pipeline,
                     v1::Posterior* posterior) const;

  bool with_features_;
  uint64_t sequence_ = 0;
  int64_t capture_time_ns_ = 0;
  bool has_onset_ = false;
  uint64_t onset_sequence_ = 0;
  int64_t onset_time_ns_ = 0;
  uint64_t decision_sequence_ = 0;
  int64_t decision_time_ns_ = 0;
  uint64_t frames_missing_ = 0;
};

}  // namespace tactus::server
