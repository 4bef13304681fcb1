// File: limits.h
//
// Every limit Tactus enforces, in one place. Tests assert on these names;
// docs and StreamStarted quote them.
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
inline constexpr size_t kMaxClientIdBytes = 128;
inline constexpr int32_t kMaxReleaseAfterMs = 60'000;

// Largest accepted taxel value, in the layout's unit: beyond any skin, and
// small enough that no square overflows.
inline constexpr float kMaxTaxelValue = 1e12F;
// Largest accepted distance of a link from the origin in metres.
inline constexpr double kMaxPositionM = 1e6;
// How far a pose's quaternion may be from unit length.
inline constexpr double kQuaternionTolerance = 1e-3;

// A sequence gap beyond this many frames is treated as this many by the
// models; it is counted in full.
inline constexpr uint64_t kMaxBridgedFrames = 100;

// Server.
inline constexpr int kMaxStreams = 2'000;
inline constexpr int kIdleTimeoutMs = 300'000;
inline constexpr int kDrainGraceMs = 5'000;
// Posteriors that must not be dropped and wait for a slow reader.
inline constexpr size_t kMaxQueuedFinals = 64;

// Models.
inline constexpr int kMaxClasses = 64;
inline constexpr int kMaxHmmStates = 256;
inline constexpr int kMaxHmmsPerClass = 256;
inline constexpr int kMaxLstmLayers = 8;
inline constexpr int kMaxLstmCells = 1'024;
inline constexpr size_t kMaxBundleBytes = 64UL * 1024 * 1024;

// Simulated contacts.
inline constexpr double kMaxSceneDurationS = 60;
inline constexpr double kMaxTrajectoryRateHz = 20'000;
inline constexpr int kMaxLeadInFrames = 1'000;

// Trial files.
inline constexpr size_t kMaxFramesPerTrial = 10'000'000;

}  // namespace tactus::limits
