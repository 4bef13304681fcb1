// File: evaluate_pictures.h
//
// The pictures of an evaluation's page (evaluate_page.h): accuracy over time,
// reliability, time to decision, and the worst trials as `trainctl show` draws
// them.
//
//   TACTUS_RETURN_IF_ERROR(CheckPictures());  // before hours of work
//   TACTUS_ASSIGN_OR_RETURN(
//       EvaluationPictures pictures,
//       DrawEvaluation(result, contacts, display.progress()));
//   TACTUS_ASSIGN_OR_RETURN(
//       pictures.worst, DrawTrials("arm.h5", worst, SkinLayout(), model,
//                                  display.progress()));
//
// Nothing is kept. Thread-safe: free functions without state.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"
#include "core/skin/layout.h"
#include "tools/common/json.h"
#include "tools/trainctl/report/evaluate_page.h"

namespace tactus::internal::client {

// IO if pictures cannot be drawn here.
absl::Status CheckPictures();

// `contacts` are those of the evaluation. Leaves `worst` empty.
absl::StatusOr<EvaluationPictures> DrawEvaluation(
    const Evaluation& result,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress = {});

// One PNG file for each of `worst` (WorstTrials()), read from the trial file at
// `path`. `given` is the skin of trials that carry none; `model` may be null:
// then no posteriors are drawn.
absl::StatusOr<std::vector<std::string>> DrawTrials(
    const std::string& path, const Json& worst, const SkinLayout& given,
    const std::shared_ptr<const CompiledModel>& model,
    const Progress& progress = {});

}  // namespace tactus::internal::client
