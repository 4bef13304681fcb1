// File: limits.h
//
// All limits that Tactus enforces. Tests assert on these names; docs and
// StreamStarted quote them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// Skin shape, taxels per side.
inline constexpr int kMaxRows = 64;
inline constexpr int kMaxColumns = 64;
inline constexpr int kMaxTaxels = kMaxRows * kMaxColumns;
// Distance of neighbouring taxels in metres, and the area of one in square
// metres: no taxel is smaller than a micrometre or larger than a metre.
inline constexpr double kMinTaxelPitchM = 1e-6;
inline constexpr double kMaxTaxelPitchM = 1;
inline constexpr double kMinTaxelAreaM2 = 1e-12;
inline constexpr double kMaxTaxelAreaM2 = 1;

// Contacts that are followed on a skin at the same time.
inline constexpr int kMaxContacts = 8;
// Contacts that ended in a trial of ClassifyTrial, in its response.
inline constexpr int kMaxTrialContacts = 64;

// One request message on a stream.
inline constexpr uint32_t kMaxFramesPerMessage = 64;
inline constexpr size_t kMaxMessageBytes = 64 * 1024;

// What a client keeps of a trial to resume its stream: at most this many bytes
// of messages. 200 s of 16 x 24 taxels as u16 with poses at 100 Hz.
inline constexpr size_t kMaxReplayBytes = 16UL * 1024 * 1024;
inline constexpr size_t kMinReplayBytes = 256UL * 1024;
// Events of a stream that wait for a robot to poll them.
inline constexpr size_t kMaxPolledEvents = 16'384;

// Stream configuration.
inline constexpr double kMinSampleRateHz = 0.01;
inline constexpr double kMaxSampleRateHz = 10'000.0;
inline constexpr uint32_t kMaxResultIntervalFrames = 10'000;
inline constexpr uint32_t kMaxDecisionFrames = 10'000;
// Names a client chooses: client_id, model, layout.
inline constexpr size_t kMaxNameBytes = 128;
inline constexpr int32_t kMaxReleaseAfterMs = 60'000;

// Largest accepted taxel value, in the layout's unit. It is larger than any
// skin reports, and its square does not overflow.
inline constexpr float kMaxTaxelValue = 1e12F;
// Smallest accepted threshold of a contact, in the same unit.
inline constexpr double kMinThreshold = 1e-38;
// Light touch: seconds of its window, taxels per side of its regions, and the
// smallest threshold; smaller values are lost in the running means.
inline constexpr double kMinLightWindowS = 0.01;
inline constexpr double kMaxLightWindowS = 1;
inline constexpr int kMaxLightSide = 16;
inline constexpr double kMinLightThreshold = 1e-12;
// Largest accepted distance of a link from the origin in metres.
inline constexpr double kMaxPositionM = 1e6;
// How far a pose's quaternion may be from unit length.
inline constexpr double kQuaternionTolerance = 1e-3;

// URDF files: their size, elements within each other, and joints.
inline constexpr size_t kMaxUrdfBytes = 4UL * 1024 * 1024;
inline constexpr int kMaxUrdfDepth = 50;
inline constexpr int kMaxUrdfJoints = 2'000;
// Largest accepted value of a joint, in radians or metres, and largest accepted
// number in the description of one.
inline constexpr double kMaxJointValue = 1e4;

// Largest accepted distance of a capture time from 0, in nanoseconds: 126
// years, so that no difference of two overflows.
inline constexpr int64_t kMaxCaptureTimeNs = 4'000'000'000'000'000'000;

// Models treat a longer sequence gap as this many frames. Counters count the
// whole gap.
inline constexpr uint64_t kMaxBridgedFrames = 100;

// One message to any service, compared before it is parsed. gRPC has one such
// limit per server; each service compares its own, smaller limit as well.
inline constexpr int kMaxReceiveBytes = 128 * 1024;
// The same of a server that takes uploads: a chunk and what is around it.
inline constexpr int kMaxUploadMessageBytes = 1024 * 1024 + 1024;
// One request of ClassifyTrial.
inline constexpr size_t kMaxTrialBytes = kMaxReceiveBytes;

// Server.
inline constexpr int kMaxStreams = 2'000;
// Streams of one peer: a host, an IPv6 /64 network, or all unix sockets. One
// peer alone cannot take all streams, and a proxy in front of a laboratory's
// robots has room for a thousand of them.
inline constexpr int kMaxStreamsPerPeer = 1'000;
inline constexpr int kIdleTimeoutMs = 300'000;
// Time a new stream has for its first message.
inline constexpr int kFirstMessageTimeoutMs = 5'000;
// Health.Watch calls, of all peers and of one.
inline constexpr int kMaxWatches = 1'000;
inline constexpr int kMaxWatchesPerPeer = 100;
// Calls that gRPC holds and that are not admitted yet; about 11 kB each.
inline constexpr int kMaxWaitingCalls = 2'000;
// Bytes that gRPC reads from a connection at once: a rapid reset fits some 400
// calls into them.
inline constexpr int kMaxReadBytes = 64 * 1024;
// Threads of gRPC's synchronous services; reflection holds one per open call.
inline constexpr int kMaxSyncThreads = 16;
// Connections, open at once: in all, and from one IPv4 address or IPv6 /64.
// Each robot may have its own; half is left to others.
inline constexpr int kMaxConnections = 4'096;
inline constexpr int kMaxConnectionsPerPeer = 2'048;
// A connection must finish TLS and begin HTTP/2 within the first, and is closed
// when it has had no call for the second.
inline constexpr int kHandshakeTimeoutMs = 10'000;
inline constexpr int kConnectionIdleMs = 300'000;
// How long a listening socket may fail to answer the server's own check.
inline constexpr int kSelfCheckMs = 10'000;
inline constexpr int kDrainGraceMs = 5'000;
// Answers that must not be dropped and wait for a slow reader.
inline constexpr size_t kMaxQueuedKept = 64;

// Models.
inline constexpr int kMaxClasses = 64;
inline constexpr int kMaxHmmStates = 256;
inline constexpr int kMaxHmmDimensions = 32;
// Taxels that a learned embedding may have ever seen touched: its fit takes
// time with their third power.
inline constexpr int kMaxEmbeddedTaxels = 1'024;
inline constexpr int kMaxHmmsPerClass = 256;
inline constexpr int kMaxLstms = 16;
inline constexpr int kMaxLstmLayers = 8;
inline constexpr int kMaxLstmCells = 1'024;
inline constexpr float kMaxLstmWeight = 1e6F;
inline constexpr size_t kMaxBundleBytes = 64UL * 1024 * 1024;
// Fields in a bundle's payload, those of nested messages included; a packed
// list counts as one. Bounds what a small file can grow to in memory.
inline constexpr int kMaxBundleFields = 200'000;
// Offsets and gains of model inputs.
inline constexpr double kMaxInputScale = 1e12;
inline constexpr size_t kMaxCalibrationEntries = 1'000;
inline constexpr size_t kMaxWarmUpFrames = 1'000;
// Largest accepted signal of a warm-up trial or a trial file: a skin full of
// the largest taxels, with room.
inline constexpr double kMaxSignal = 1e16;
inline constexpr size_t kMaxProvenanceBytes = 64 * 1024;
// Trials that a bundle names as those that it was fitted to.
inline constexpr size_t kMaxProvenanceTrials = 65'536;
// Largest accepted logarithm of a variance that a network regresses.
inline constexpr double kMaxLogVariance = 200;

// Simulated contacts.
inline constexpr double kMaxSceneDurationS = 60;
inline constexpr double kMaxTrajectoryRateHz = 20'000;
inline constexpr int kMaxLeadInFrames = 1'000;
// Objects that press at once in one trial.
inline constexpr int kMaxSceneObjects = 4;
inline constexpr uint64_t kMaxWorldContacts = 10'000'000;

// Training service.
// Calls of it that run at once, of all peers and of one; each has a thread.
inline constexpr int kMaxControlCalls = 64;
inline constexpr int kMaxControlCallsPerPeer = 48;
// Time a call may wait for its client to send or take a message.
inline constexpr int kControlTimeoutMs = 30'000;
inline constexpr size_t kMaxDescriptionBytes = 1'024;
// One chunk of an upload.
inline constexpr size_t kMaxChunkBytes = 1024 * 1024;
// One trial of an upload, and one upload.
inline constexpr int64_t kMaxTrialRecordBytes = 64L * 1024 * 1024;
inline constexpr int64_t kMaxUploadBytes = 64L * 1024 * 1024 * 1024;
// Trials that one request relabels or removes.
inline constexpr int kMaxChosenTrials = 10'000;
// Trials that the answer to an upload, and the result of a job, name.
inline constexpr int kMaxTrialNotes = 100;
inline constexpr int kMaxNamedTrials = 20;
// One message of a job to the server.
inline constexpr size_t kMaxJobEventBytes = 64 * 1024;
// Epochs of LSTM training.
inline constexpr int kMaxEpochs = 10'000;
// Work that the choice of a preset may take, in billions of multiplications.
inline constexpr uint32_t kMaxChoiceWork = 1'000'000;
// Jobs that wait.
inline constexpr int kMaxQueuedJobs = 200;
// The end of a job's log that is kept after the job, and one message of it.
inline constexpr int64_t kMaxJobLogBytes = 64 * 1024;
inline constexpr size_t kJobLogMessageBytes = 16 * 1024;
// What one client may have by default: a token, a certificate, or a peer
// without credentials. Bytes of unfinished uploads and of the trials that it
// added to datasets, datasets that it created, and jobs of it that wait.
inline constexpr int64_t kMaxClientBytes = 256L * 1024 * 1024 * 1024;
inline constexpr int kMaxClientDatasets = 1'000;
inline constexpr int kMaxClientQueuedJobs = 150;
// An upload that nobody wrote to for this time is removed; how often the server
// looks for such uploads.
inline constexpr int64_t kAbandonedUploadMs = 7L * 24 * 3'600 * 1'000;
inline constexpr int64_t kSweepIntervalMs = 24L * 3'600 * 1'000;

// Trial files.
inline constexpr size_t kMaxFramesPerTrial = 10'000'000;
// One array of a trial in memory: four hours of 384 u16 taxels at 100 Hz.
inline constexpr size_t kMaxTrialArrayBytes = 1024UL * 1024 * 1024;
inline constexpr size_t kMaxTrialTextBytes = 256;
inline constexpr size_t kMaxTrialIdBytes = 64;
inline constexpr size_t kMaxTouchesPerTrial = 64;
// Largest accepted time of a trial in seconds, as kMaxCaptureTimeNs.
inline constexpr double kMaxTrialTimeS = 4e9;
// Memory of the process that reads a trial file first, beyond what it has.
inline constexpr size_t kMaxProbeBytes = 4096UL * 1024 * 1024;
inline constexpr size_t kMaxTrialsPerFile = 1'000'000;
// Text files that are imported.
inline constexpr size_t kMaxCsvBytes = 256UL * 1024 * 1024;
inline constexpr size_t kMaxCsvColumns = 1'000;
inline constexpr size_t kMaxCsvMetadata = 100;
inline constexpr size_t kMaxCsvCells = 20'000'000;
// MCAP files: a record that is read as a whole (chunks, messages), the schemas
// and channels of a file together, and one record of metadata.
inline constexpr size_t kMaxMcapRecordBytes = 64UL * 1024 * 1024;
inline constexpr size_t kMaxMcapSchemaBytes = 16UL * 1024 * 1024;
inline constexpr size_t kMaxMcapMetadataBytes = 1024 * 1024;

}  // namespace tactus::internal::limits
