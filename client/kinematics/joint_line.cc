#include "client/kinematics/joint_line.h"

#include <cstddef>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

constexpr absl::string_view kBlanks = " \t\r\n";

// Takes the next word from `line`; empty if there is none.
absl::string_view NextWord(absl::string_view& line) {
  const size_t begin = line.find_first_not_of(kBlanks);
  if (begin == absl::string_view::npos) return line = {};
  line.remove_prefix(begin);
  const absl::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

}  // namespace

absl::Status ParseJointLine(absl::string_view line, int64_t& time_ns,
                            std::span<double> values) {
  const absl::string_view time = NextWord(line);
  if (!absl::SimpleAtoi(time, &time_ns)) {
    return InvalidConfig("time of the joint values", Quoted(time),
                         "a whole number of nanoseconds");
  }
  size_t count = 0;
  for (absl::string_view word = NextWord(line); !word.empty();
       word = NextWord(line), ++count) {
    if (count >= values.size()) continue;
    if (!absl::SimpleAtod(word, &values[count])) {
      return InvalidConfig(absl::StrCat("joint value ", count + 1),
                           Quoted(word), "a number");
    }
  }
  if (count == values.size()) return absl::OkStatus();
  return InvalidConfig("number of joint values", count,
                       absl::StrCat(values.size(), ", after the time"));
}

}  // namespace tactus::internal::client
