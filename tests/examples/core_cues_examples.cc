// The examples in the headers of core/cues.
#include <algorithm>

#include "core/cues/cue.h"
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"
#include "core/cues/cue_tracker.h"

namespace tactus::internal::examples {

static absl::string_view CueExample() {
#include "core/cues/cue.h.inc"
  return "";
}

static void CueTrackerExample(const ContactSample& sample) {
#include "core/cues/cue_tracker.h.inc"
}

static void CueGroupExample() {
#include "core/cues/cue_group.h.inc"
}

static void CueMathExample(const CueStep& step, double window,
                           std::span<double> cues) {
#include "core/cues/cue_math.h.inc"
}

}  // namespace tactus::internal::examples
