// File: evaluate_answers.h
//
// The answers of an evaluation, one line a felt trial, as CSV (RFC 4180):
// what `trainctl evaluate --answers=FILE` writes.
//
//   TACTUS_RETURN_IF_ERROR(
//       WriteFileBytes("answers.csv", AnswersCsv(result, contacts)));
//
// | column | meaning |
// |---|---|
// | trial | the id |
// | label | the class in the end |
// | label_so_far | the class so far at the last frame, if it is another |
// | answer | the most probable class after the last frame |
// | probability_NAME | of each class NAME, after the last frame |
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"

namespace tactus::internal::client {

// `contacts` are those of the evaluation.
std::string AnswersCsv(const Evaluation& result,
                       const std::vector<const LabelledContact*>& contacts);

}  // namespace tactus::internal::client
