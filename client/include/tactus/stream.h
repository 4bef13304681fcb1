// File: stream.h
//
// Stream: frames of one skin go in, answers and events come out. A server
// answers (client.h), the same code in this process (classifier.h), or a test
// (mock.h); all answers have the same bits.
//
//   for (int t = 0; t < 100; ++t) {
//     ReadSkin(frame);
//     const absl::Status pushed = stream.Push(frame);
//     if (!pushed.ok()) return pushed;
//     for (Event event; stream.Poll(event);) Use(event);
//   }
//   const absl::StatusOr<Answer> answer = stream.EndTrial();
//   return stream.Close();
//
// Events come through StreamOptions::on_event if it is set, else they wait for
// Poll. Once a stream has ended, every call returns the error that it ended
// with; after an end without error, Close returns OK and the other calls
// STREAM_FINISHED.
//
// Push, EndTrial and Close belong to one thread. Callbacks must not call them,
// nor destroy the stream; they run where client.h and classifier.h say. All
// other calls may be made from any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "tactus/answer.h"
#include "tactus/skin.h"

namespace tactus {

// News about a stream, not about a contact.
struct Notice {
  enum class Kind {
    // The server shuts down.
    kDraining,
    // The server has a newer version of the model. This stream keeps its own; a
    // new one gets the newer version.
    kModelSuperseded,
    // The capture times are those of another rate than the skin's.
    kRateDiffers,
    // Some taxels read unlike in any recording that the model was fitted to.
    kSkinDiffers,
  };

  Kind kind = Kind::kDraining;
  // For people.
  std::string text = {};
};

// Which answers come; finals and answers with events always do.
enum class Cadence {
  // After every StreamOptions::interval_frames-th frame.
  kInterval,
  // When the number of contacts, or what they probably are, changes.
  kOnChange,
  // No others.
  kEvents,
};

struct StreamOptions {
  // "M", "M@V" or the name of an alias; empty: the served model that fits the
  // skin ("default" if it fits, else the first by name).
  std::string model = {};
  // Names the robot in the server's logs; at most 128 bytes.
  std::string client_id = {};

  Cadence cadence = Cadence::kInterval;
  int interval_frames = 1;
  // Frames that travel in one message, 1 to 64; they count as one sample period
  // apart. More cost less and answer later.
  int frames_per_message = 1;

  // What decides a question; absent: what the model was calibrated to.
  std::optional<double> decision_threshold = std::nullopt;
  std::optional<int> decision_frames = std::nullopt;
  // A contact ends at the latest this long after its last touch; absent: the
  // model's own.
  std::optional<std::chrono::milliseconds> release_after = std::nullopt;
  // Only EndTrial ends a contact.
  bool never_release = false;
  // Contacts that are followed at the same time, 1 to 8; absent: 8, or 1 for
  // models of the whole skin.
  std::optional<int> max_contacts = std::nullopt;
  // About half of the computing time: less accurate, no Contact::object.
  bool low_effort = false;
  // Fill in ContactPatch::taxels.
  bool with_taxels = false;

  // Called for each answer, event and notice; what they get is valid until they
  // return.
  std::function<void(const Answer&)> on_answer = {};
  std::function<void(const Event&)> on_event = {};
  std::function<void(const Notice&)> on_notice = {};
};

struct QuestionInfo {
  std::string name = {};
  // True if the answer may change during a contact.
  bool is_state = false;
  std::vector<std::string> values = {};
};

// What answers a stream.
struct StreamInfo {
  // "models/M/versions/V"; in process, the path of the model's file.
  std::string model_version = {};
  // SHA-256 of the model's file, hexadecimal.
  std::string model_sha256 = {};
  std::vector<std::string> classes = {};
  std::vector<QuestionInfo> questions = {};
  // Taxels of a frame, and values of each.
  int rows = 0;
  int columns = 0;
  int axes = 1;
  int max_contacts = 0;
};

struct StreamStatistics {
  uint64_t frames = 0;
  // Connections after the first, the frames that were sent again, and how often
  // the beginning of a trial or contact was no longer kept.
  uint64_t resumed = 0;
  uint64_t frames_sent_again = 0;
  uint64_t without_beginning = 0;
  // Events that nobody polled: the oldest are dropped beyond 16,384.
  uint64_t events_dropped = 0;
};

class Stream {
 public:
  // Ends the stream at once unless it was closed.
  virtual ~Stream() = default;

  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // Fixed from the beginning.
  virtual const StreamInfo& info() const = 0;

  // Takes the next frame. INVALID_CONFIG if its values are not as many as the
  // skin has, or not as its encoding says; the stream then goes on.
  virtual absl::Status Push(const Frame& frame) = 0;
  // Ends the trial and returns its final answer. The next frame begins another.
  virtual absl::StatusOr<Answer> EndTrial() = 0;
  // Ends an open trial and the stream.
  virtual absl::Status Close() = 0;

  // Takes the oldest event that waits into `event`; false if none does.
  virtual bool Poll(Event& event) = 0;

  // True once no further answer can come.
  virtual bool ended() = 0;
  // True while a lost connection is being resumed.
  virtual bool resuming() = 0;
  virtual StreamStatistics statistics() = 0;
  // Ends the stream at once.
  virtual void Cancel() = 0;

 protected:
  Stream() = default;
};

}  // namespace tactus
