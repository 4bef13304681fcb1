// File: sim_touches.h
//
// SimTouches: the simulated contacts of SimDriver, one after another on a
// clock, as an iCub's boards would feel them.
//
//   SimTouches touches({.contacts = 40, .begin_ns = 3'000'000'000});
//   IcubBoards boards(touches.boards(), touches.Source());
//   const std::string label = touches.LabelAt(contact_onset_ns);
//
// The skin has the layout "cody-forearm"; cell c of it is value c of the port:
// boards 1 and 2 with 16 triangles of 12 dots each, none of them a thermal pad.
// Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/drivers/icub_skin/skin_patch.h"
#include "client/drivers/sim_driver.h"
#include "tools/fakeskin/icub_boards.h"

namespace tactus::internal::client {

struct SimTouchesOptions {
  uint64_t seed = 1;
  size_t contacts = 40;
  // When the first contact's frames begin, on the clock of the boards.
  int64_t begin_ns = 0;
  // Between the contacts: longer than the model waits for a release.
  int64_t pause_ns = 1'000'000'000;
  // Where the contacts are; nothing for places drawn from the seed.
  std::optional<SkinPoint> centre = std::nullopt;
  // What one count of a board stands for: at most the contact threshold, or
  // the answers get worse.
  double newton_per_count = 0.01;
};

class SimTouches {
 public:
  explicit SimTouches(const SimTouchesOptions& options);

  // Makes all contacts now, which takes a while, so that none has to be made
  // while a bus waits. Else each one is made when it is its turn.
  void MakeAll();
  // Lets the contacts that are made begin at another time.
  void BeginAt(int64_t begin_ns);

  // Boards, layout and cells of this skin.
  const icub::SkinPatch& patch() const { return patch_; }
  // The forces on cells of the layout from `first` on, at a time; all are 0
  // before. May be called for times that do not fall by more than one contact;
  // for any after MakeAll.
  void ForcesAt(int64_t time_ns, size_t first, std::span<double> newtons);
  // The same for the dots of a board.
  IcubBoards::Source Source();
  // The pose of the link; that of the last contact between contacts.
  Pose PoseAt(int64_t time_ns);
  // The label of the contact that is played at this time, or was last; empty
  // before the first.
  std::string LabelAt(int64_t time_ns);
  // Number of contacts that have begun.
  size_t Begun(int64_t time_ns);
  // When the last contact has ended, with its pause; nothing until it is
  // known.
  std::optional<int64_t> end_ns() const { return end_ns_; }

 private:
  struct Touch {
    int64_t begin_ns = 0;
    int64_t end_ns = 0;
    Trial trial;
  };
  // The contact that begins last before `time_ns`; null before the first.
  const Touch* At(int64_t time_ns);
  bool MakeNext();

  const SimTouchesOptions options_;
  icub::SkinPatch patch_;
  SimDriver driver_;
  size_t made_ = 0;
  bool keep_all_ = false;
  std::vector<Touch> touches_;
  std::optional<int64_t> end_ns_;
};

}  // namespace tactus::internal::client
