// File: training_rpcs.h
//
// The RPCs of TrainingService, OperationService and ModelService. Each checks
// its request, calls the backend and answers.
//
//   AddTrainingRpcs(backend, control);
//   AddOperationRpcs(backend, control);
//   AddModelRpcs(backend, control);
//
// `backend` may be null: each RPC then ends with NO_DATA_DIRECTORY. It must
// outlive the calls. Not thread-safe: call them before the server starts.
#pragma once

#include <string>

#include "server/jobs/training_backend.h"
#include "server/rpc/control_service.h"

namespace tactus::internal::server {

void AddTrainingRpcs(TrainingBackend* backend, ControlService& control);
// Its parts.
void AddDatasetRpcs(TrainingBackend* backend, ControlService& control);
void AddUploadRpcs(TrainingBackend* backend, ControlService& control);
void AddOperationRpcs(TrainingBackend* backend, ControlService& control);
void AddModelRpcs(TrainingBackend* backend, ControlService& control);

// Adds a handler, or one that answers NO_DATA_DIRECTORY if `backend` is null.
void AddRpc(TrainingBackend* backend, ControlService& control,
            const std::string& method, Role role,
            ControlService::Handler handler);

}  // namespace tactus::internal::server
