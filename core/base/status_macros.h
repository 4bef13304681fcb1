// File: status_macros.h
//
// Early return on error.
//
//   TACTUS_RETURN_IF_ERROR(Validate(layout));
//   TACTUS_ASSIGN_OR_RETURN(Model model, LoadModel(path));
//
// Both evaluate their expression once. The function that uses them must return
// absl::Status or absl::StatusOr.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"

#define TACTUS_CONCAT_INNER_(a, b) a##b
#define TACTUS_CONCAT_(a, b) TACTUS_CONCAT_INNER_(a, b)

#define TACTUS_RETURN_IF_ERROR(expression)                                \
  do {                                                                    \
    if (absl::Status tactus_status = (expression); !tactus_status.ok()) { \
      return tactus_status;                                               \
    }                                                                     \
  } while (false)

#define TACTUS_ASSIGN_OR_RETURN(declaration, expression)                     \
  TACTUS_ASSIGN_OR_RETURN_IMPL_(TACTUS_CONCAT_(tactus_status_or_, __LINE__), \
                                declaration, expression)

#define TACTUS_ASSIGN_OR_RETURN_IMPL_(holder, declaration, expression) \
  auto holder = (expression);                                          \
  if (!holder.ok()) return std::move(holder).status();                 \
  declaration = std::move(*holder)
