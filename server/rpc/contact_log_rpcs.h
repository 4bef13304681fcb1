// File: contact_log_rpcs.h
//
// The RPCs of ContactLogService.
//
//   AddContactLogRpcs(log, &models, backend, control);
//
// Without a log each RPC ends with NO_CONTACT_LOG, without a backend labels end
// with NO_DATA_DIRECTORY. All must outlive the calls. Not thread-safe: call it
// before the server starts.
#pragma once

#include "server/contact_log/contact_log.h"
#include "server/jobs/training_backend.h"
#include "server/rpc/control_service.h"
#include "server/session/model_source.h"

namespace tactus::internal::server {

void AddContactLogRpcs(ContactLog* log, const ModelSource* models,
                       TrainingBackend* backend, ControlService& control);

}  // namespace tactus::internal::server
