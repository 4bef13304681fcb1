// Classifies the contacts of a trial file in this process, without a server.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/contact_pipeline.h"
#include "core/data/trial_file.h"
#include "core/data/trial_layout.h"
#include "core/files/file_bytes.h"

absl::Status Classify(
    const tactus::Trial& trial,
    const std::shared_ptr<const tactus::CompiledModel>& model) {
  TACTUS_ASSIGN_OR_RETURN(const tactus::SkinLayout skin,
                          tactus::LayoutOfTrial(trial));
  tactus::ContactPipeline::Options options;
  options.sample_rate_hz = trial.sample_rate_hz;
  options.with_poses = !trial.poses.empty();
  TACTUS_ASSIGN_OR_RETURN(const auto pipeline, tactus::ContactPipeline::Create(
                                                   skin, model, options));
  std::vector<float> taxels(skin.taxels());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, taxels.data());  // Read your skin here.
    tactus::FrameView frame{.taxels = taxels};
    if (options.with_poses) frame.pose = &trial.poses[t];
    for (const tactus::ContactReport& contact : pipeline->Step(frame)) {
      if (contact.classifier->decisions()[0].decided()) {
        // A robot would react here, while it still touches.
      }
    }
  }
  std::printf("%s", trial.id.c_str());
  if (const tactus::ContactReport* contact = pipeline->main_contact()) {
    for (const double probability : contact->classifier->probability()) {
      std::printf(" %.17g", probability);
    }
  }
  std::printf("\n");
  return absl::OkStatus();
}

absl::Status Run(const char* bundle, const char* trials) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      tactus::ReadFileBytes(bundle, tactus::limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(const auto model, tactus::DecodeBundle(bytes));
  TACTUS_ASSIGN_OR_RETURN(const auto reader,
                          tactus::TrialFileReader::Open(trials));
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const tactus::Trial trial, reader.Read(i));
    TACTUS_RETURN_IF_ERROR(Classify(trial, model));
  }
  return absl::OkStatus();
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: in_process MODEL.tactus TRIALS.h5\n");
    return 2;
  }
  const absl::Status status = Run(argv[1], argv[2]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
