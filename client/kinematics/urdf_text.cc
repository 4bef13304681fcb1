#include "client/kinematics/urdf_text.h"

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kNone = absl::string_view::npos;

// The end of the markup that begins at `at` without being an element: behind
// `end`, or the end of the text.
size_t Behind(absl::string_view text, size_t at, absl::string_view end) {
  const size_t found = text.find(end, at);
  return found == kNone ? text.size() : found + end.size();
}

// The '>' that ends the tag at `at`; one between quotes does not.
size_t EndOfTag(absl::string_view text, size_t at) {
  char quote = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      break;
    }
  }
  return at;
}

bool IsJoint(absl::string_view tag) {
  return absl::StartsWith(tag, "<joint") &&
         (tag.size() == 6 || !absl::ascii_isalnum(tag[6]));
}

}  // namespace

absl::Status CheckUrdfText(absl::string_view urdf) {
  if (urdf.size() > limits::kMaxUrdfBytes) {
    return InvalidConfig("size of the URDF in bytes", urdf.size(),
                         absl::StrCat("at most ", limits::kMaxUrdfBytes));
  }
  if (urdf.find('\0') != kNone) {
    return InvalidConfig("the URDF", "text with a byte 0", "XML");
  }
  int depth = 0;
  int joints = 0;
  for (size_t at = urdf.find('<'); at < urdf.size(); at = urdf.find('<', at)) {
    const absl::string_view rest = urdf.substr(at);
    if (absl::StartsWith(rest, "<!--")) {
      at = Behind(urdf, at + 4, "-->");
    } else if (absl::StartsWith(rest, "<![CDATA[")) {
      at = Behind(urdf, at, "]]>");
    } else if (absl::StartsWith(rest, "<!") || absl::StartsWith(rest, "<?")) {
      at = Behind(urdf, at, ">");
    } else if (absl::StartsWith(rest, "</")) {
      if (depth > 0) --depth;
      at = Behind(urdf, at, ">");
    } else {
      if (IsJoint(rest)) ++joints;
      at = EndOfTag(urdf, at);
      const bool is_empty = at < urdf.size() && urdf[at - 1] == '/';
      if (!is_empty) ++depth;
    }
    if (depth > limits::kMaxUrdfDepth) {
      return InvalidConfig("nesting of the URDF's elements", depth,
                           absl::StrCat("at most ", limits::kMaxUrdfDepth));
    }
    if (joints > limits::kMaxUrdfJoints) {
      return InvalidConfig("number of joints in the URDF", joints,
                           absl::StrCat("at most ", limits::kMaxUrdfJoints));
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
