// File: contact_picture.h
//
// One contact as people would look at it: a strip of the skin's pictures from
// the onset on; under it force, area and motion over time; under these the
// posteriors with the decision marked.
//
//   TACTUS_ASSIGN_OR_RETURN(const ContactTrace trace,
//                           TraceContact(trial, layout, model));
//   TACTUS_RETURN_IF_ERROR(
//       DrawToFile(ScriptOf(trace).text(), "contact.png"));
//
// 1,600 pixels wide; readable at half of that. Free functions without state;
// thread-safe. The same trace gives the same script.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "tools/figures/gnuplot_script.h"
#include "tools/trainctl/data/contact_trace.h"

namespace tactus::internal::client {

inline constexpr int kContactPictureWidth = 1600;
// Pictures of the skin in the strip.
inline constexpr int kSkinPictures = 8;

// Leaves out the strip if the trace holds no frames of a skin, and the
// posteriors if it holds none. The trace has at least one frame.
GnuplotScript ScriptOf(const ContactTrace& trace);

// Indices of the frames in the strip: the onset, then ever longer steps to the
// release or the end.
std::vector<size_t> PicturedFrames(const ContactTrace& trace);

// "hard, moved (HM)" for the four classes of the default bundle; other names
// as they are.
std::string DescribeClass(absl::string_view name);

}  // namespace tactus::internal::client
