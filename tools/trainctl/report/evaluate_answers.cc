#include "tools/trainctl/report/evaluate_answers.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"

namespace tactus::internal::client {
namespace {

// A field of a CSV file; in quotes if it holds what separates fields.
std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

}  // namespace

std::string AnswersCsv(const Evaluation& result,
                       const std::vector<const LabelledContact*>& contacts) {
  std::string csv = "trial,label,label_so_far,answer";
  for (const std::string& name : result.class_names) {
    absl::StrAppend(&csv, ",", Field(absl::StrCat("probability_", name)));
  }
  csv += "\n";
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& contact = *contacts[i];
    const Outcome& outcome = result.final[i];
    const std::string so_far = LabelSoFar(contact, contact.frames.size() - 1);
    absl::StrAppend(&csv, Field(ContactName(contact)), ",",
                    Field(contact.label), ",",
                    Field(so_far == contact.label ? "" : so_far), ",",
                    Field(result.class_names[outcome.answer()]));
    for (const double probability : outcome.probability) {
      absl::StrAppendFormat(&csv, ",%.9g", probability);
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace tactus::internal::client
