// File: live_observer.h
//
// LiveObserver: sees each frame and each answer of a LivePlayer.
//
//   class Screen : public LiveObserver { ... };
//   LivePlayer player(channel, &driver, {.observer = &screen}, ...);
//
// OnAnswer is called on the stream's reading thread, everything else on the
// thread of LivePlayer::Run.
#pragma once

#include <cstdint>

#include "client/stream/skin_frame.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class LiveObserver {
 public:
  virtual ~LiveObserver() = default;

  // Before the first frame.
  virtual void OnStarted(const SkinInfo& info,
                         const v1::StreamStarted& started) = 0;
  // A frame is about to be sent with this sequence number.
  virtual void OnFrame(const SkinFrame& frame, uint64_t sequence) = 0;
  virtual void OnAnswer(const v1::Answer& answer) = 0;
  // The driver was read, which happens at least ten times a second, with or
  // without a frame.
  virtual void OnRead() = 0;
};

}  // namespace tactus::internal::client
