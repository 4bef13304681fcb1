// File: limits.h
//
// All limits that Tactus enforces. Tests assert on these names; docs and
// StreamStarted quote them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::limits {

// Skin shape, taxels per side.
inline constexpr int kMaxRows = 64;
inline constexpr int kMaxColumns = 64;
inline constexpr int kMaxTaxels = kMaxRows * kMaxColumns;

// One request message on a stream.
inline constexpr uint32_t kMaxFramesPerMessage = 64;
inline constexpr size_t kMaxMessageBytes = 64 * 1024;

// Stream configuration.
inline constexpr double kMaxSampleRateHz = 10'000.0;
inline constexpr uint32_t kMaxResultIntervalFrames = 10'000;
inline constexpr uint32_t kMaxDecisionFrames = 10'000;
// Names a client chooses: client_id, model, layout.
inline constexpr size_t kMaxNameBytes = 128;
inline constexpr int32_t kMaxReleaseAfterMs = 60'000;

// Largest accepted taxel value, in the layout's unit. It is larger than any
// skin reports, and its square does not overflow.
inline constexpr float kMaxTaxelValue = 1e12F;
// Largest accepted distance of a link from the origin in metres.
inline constexpr double kMaxPositionM = 1e6;
// How far a pose's quaternion may be from unit length.
inline constexpr double kQuaternionTolerance = 1e-3;

// Largest accepted distance of a capture time from 0, in nanoseconds: 126
// years, so that no difference of two overflows.
inline constexpr int64_t kMaxCaptureTimeNs = 4'000'000'000'000'000'000;

// Models treat a longer sequence gap as this many frames. Counters count the
// whole gap.
inline constexpr uint64_t kMaxBridgedFrames = 100;

// One message to any service, compared before it is parsed. gRPC has one such
// limit per server; each service compares its own, smaller limit as well.
inline constexpr int kMaxReceiveBytes = 128 * 1024;
// One request of ClassifyTrial.
inline constexpr size_t kMaxTrialBytes = kMaxReceiveBytes;

// Server.
inline constexpr int kMaxStreams = 2'000;
inline constexpr int kIdleTimeoutMs = 300'000;
inline constexpr int kDrainGraceMs = 5'000;
// Posteriors that must not be dropped and wait for a slow reader.
inline constexpr size_t kMaxQueuedFinals = 64;

// Models.
inline constexpr int kMaxClasses = 64;
inline constexpr int kMaxHmmStates = 256;
inline constexpr int kMaxHmmDimensions = 16;
inline constexpr int kMaxHmmsPerClass = 256;
inline constexpr int kMaxLstms = 16;
inline constexpr int kMaxLstmLayers = 8;
inline constexpr int kMaxLstmCells = 1'024;
inline constexpr float kMaxLstmWeight = 1e6F;
inline constexpr size_t kMaxBundleBytes = 64UL * 1024 * 1024;

// Simulated contacts.
inline constexpr double kMaxSceneDurationS = 60;
inline constexpr double kMaxTrajectoryRateHz = 20'000;
inline constexpr int kMaxLeadInFrames = 1'000;

// Trial files.
inline constexpr size_t kMaxFramesPerTrial = 10'000'000;
// One array of a trial in memory: four hours of 384 u16 taxels at 100 Hz.
inline constexpr size_t kMaxTrialArrayBytes = 1024UL * 1024 * 1024;
inline constexpr size_t kMaxTrialTextBytes = 256;
inline constexpr size_t kMaxTrialsPerFile = 1'000'000;
// Text files that are imported.
inline constexpr size_t kMaxCsvBytes = 256UL * 1024 * 1024;

}  // namespace tactus::limits
