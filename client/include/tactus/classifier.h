// File: classifier.h
//
// Classifier: answers in this process, without a server and without gRPC. It
// runs the code that a server runs; its answers have the same bits.
//
//   auto classifier = Classifier::Load("no-poses.tactus");
//   if (!classifier.ok()) return classifier.status();
//   auto stream = classifier->Open({.name = "cody-forearm", .scale = 0.001});
//   if (!stream.ok()) return stream.status();
//   return (*stream)->Push(frame);
//
// It has no threads: callbacks run within Push, EndTrial and Close, and a frame
// is answered when Push returns. A frame that is wrong, such as one with a
// negative value, ends its stream, as with a server.
//
// Open may be called from any thread. Streams outlive their classifier.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "tactus/skin.h"
#include "tactus/stream.h"

namespace tactus {

class Classifier {
 public:
  // Reads a model's file (trainctl fit) and checks that it computes here what
  // it computed where it was made. IO, BUNDLE_CORRUPT, BUNDLE_VERSION,
  // INVALID_MODEL.
  static absl::StatusOr<Classifier> Load(const std::string& path);
  // The same for a file that is in memory already; `name` stands for its path.
  static absl::StatusOr<Classifier> Parse(std::string_view bytes,
                                          const std::string& name);

  ~Classifier();
  Classifier(Classifier&&) noexcept;
  Classifier& operator=(Classifier&&) noexcept;

  // The errors of a server. `model` of the options is empty, because the file
  // is the model; frames_per_message has no effect.
  absl::StatusOr<std::unique_ptr<Stream>> Open(
      const Skin& skin, const StreamOptions& options = {}) const;

 private:
  class Impl;
  explicit Classifier(std::unique_ptr<const Impl> impl);

  std::unique_ptr<const Impl> impl_;
};

}  // namespace tactus
