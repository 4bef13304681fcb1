// File: posterior_writer.h
//
// PosteriorWriter: writes the pipeline's results after a frame into a
// Posterior. It keeps the sequence numbers and capture times of onset and
// decision, which the pipeline does not know.
//
//   writer.OnFrame(pipeline.Step(frame), sequence, time_ns, missing_before);
//   writer.Write(pipeline, false, posterior);
//
// Allocates nothing once the posteriors have grown to their size. Not
// thread-safe: one per stream.
#pragma once

#include <cstdint>

#include "core/classify/contact_pipeline.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::server {

class PosteriorWriter {
 public:
  explicit PosteriorWriter(bool with_features)
      : with_features_(with_features) {}

  // Records the frame that `report` belongs to; `missing_before` frames were
  // lost directly before it.
  void OnFrame(const ContactReport& report, uint64_t sequence,
               int64_t capture_time_ns, uint64_t missing_before);
  // Resets what belongs to a trial.
  void OnEndOfTrial();

  // Overwrites all fields of `posterior` except server_compute_ns, queue_ns and
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
