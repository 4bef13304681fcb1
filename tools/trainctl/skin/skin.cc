// trainctl skin estimate: proposes thresholds from what an idle skin reports.
#include <iostream>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/import/idle_noise.h"
#include "core/import/light_noise.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct SkinFlags {
  std::string path;
  std::optional<int> idle_frames;
  std::optional<double> idle_taxels;
  bool json = false;
};

absl::StatusOr<IdleValues> Which(const SkinFlags& flags) {
  constexpr int kDefaultFrames = 10;
  if (flags.idle_frames && flags.idle_taxels) {
    return InvalidConfig("--idle-frames and --idle-taxels", "both given",
                         "one of the two");
  }
  if (flags.idle_taxels) {
    if (!(*flags.idle_taxels > 0 && *flags.idle_taxels < 1)) {
      return InvalidConfig("--idle-taxels", *flags.idle_taxels,
                           "a fraction above 0 and below 1");
    }
    return IdleValues{.taxels = *flags.idle_taxels};
  }
  const int frames = flags.idle_frames.value_or(kDefaultFrames);
  if (frames < 1) return InvalidConfig("--idle-frames", frames, "1 or more");
  return IdleValues{.frames = frames};
}

std::string Words(const IdleValues& which) {
  return which.frames > 0
             ? absl::StrFormat("the first %d frames of each trial",
                               which.frames)
             : absl::StrFormat(
                   "the %g %% of the taxels with the least load in "
                   "each trial",
                   100 * which.taxels);
}

// As a layout in JSON has it.
Json LightJson(const std::optional<LightTouch>& light) {
  if (!light) return nullptr;
  return {{"window_s", light->window_s},
          {"rows", light->rows},
          {"columns", light->columns},
          {"contact_threshold", light->contact_threshold},
          {"onset_threshold", light->onset_threshold}};
}

absl::Status RunSkin(const SkinFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const IdleValues which, Which(flags));
  TACTUS_ASSIGN_OR_RETURN(const auto reader, TrialFileReader::Open(flags.path));
  IdleNoise noise(which);
  LightNoise light_noise(which.frames);
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    noise.Add(trial);
    light_noise.Add(trial);
  }
  TACTUS_ASSIGN_OR_RETURN(const IdleEstimate found, noise.Estimate());
  const std::optional<LightTouch> light = light_noise.Estimate();
  if (flags.json) {
    std::cout << JsonText(Json{{"trials", reader.size()},
                               {"idle", Words(which)},
                               {"values", found.values},
                               {"median", found.median},
                               {"p99.9", found.percentile_999},
                               {"largest", found.largest},
                               {"peak", found.peak},
                               {"margin", found.margin},
                               {"contact_threshold", found.contact_threshold},
                               {"onset_threshold", found.onset_threshold},
                               {"light_touch", LightJson(light)}})
              << "\n";
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat(
      "%s: %s trials; idle are %s, %s values\n"
      "idle values: median %g, 99.9th percentile %g, largest %g\n"
      "largest value of the median trial: %g\n"
      "margin %g: the larger of half of percentile - median and 2 %% of the "
      "largest value\n"
      "\"contact_threshold\": %.4g,   percentile + margin\n"
      "\"onset_threshold\": %.4g,   percentile + 2 x margin\n",
      flags.path, WithCommas(static_cast<int>(reader.size())), Words(which),
      WithCommas(static_cast<int>(found.values)), found.median,
      found.percentile_999, found.largest, found.peak, found.margin,
      found.contact_threshold, found.onset_threshold);
  if (light) {
    std::cout << absl::StrFormat(
        "\"light_touch\": {\"window_s\": %g, \"rows\": %d, \"columns\": %d, "
        "\"contact_threshold\": %.4g, \"onset_threshold\": %.4g},   5 and 7 "
        "deviations of the noisiest region\n",
        light->window_s, light->rows, light->columns, light->contact_threshold,
        light->onset_threshold);
  }
  return absl::OkStatus();
}

}  // namespace

void AddSkin(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<SkinFlags>();
  CLI::App& group =
      CommandGroup(app, "skin", "Learn about a skin", "estimate mine.h5");
  CLI::App* command = &AddVerb(
      group, "estimate", "Propose thresholds from the values of an idle skin",
      "estimate mine.h5");
  command->add_option("file", flags->path, "Trial file")->required();
  command->add_option("--idle-frames", flags->idle_frames,
                      "The skin is untouched in this many first frames of each "
                      "trial; default 10");
  command->add_option("--idle-taxels", flags->idle_taxels,
                      "Or: this fraction of the taxels is untouched in each "
                      "trial, for recordings that begin in contact");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunSkin(*flags); }); });
}

}  // namespace tactus::internal::client
