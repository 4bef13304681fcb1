#include "client/drivers/icub_skin/icub_skin.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client::icub {
namespace {

// Periods that are waited at most until stopped boards are silent.
constexpr int kMaxDrains = 50;

// "triangles 3, 5, 9".
std::string TriangleList(uint16_t triangles) {
  std::vector<int> list;
  for (int t = 0; t < kTriangles; ++t) {
    if ((triangles >> t & 1) != 0) list.push_back(t);
  }
  return absl::StrCat(list.size() == 1 ? "triangle " : "triangles ",
                      absl::StrJoin(list, ", "));
}

// Calls `use` with each frame that comes within `duration_ns`.
template <typename Use>
absl::Status Listen(CanBus& bus, Clock& clock, int64_t duration_ns, Use use) {
  const int64_t end_ns = clock.NowNs() + duration_ns;
  for (int64_t now_ns = clock.NowNs(); now_ns < end_ns;
       now_ns = clock.NowNs()) {
    CanFrame frame;
    TACTUS_ASSIGN_OR_RETURN(const bool received,
                            bus.Receive(frame, end_ns - now_ns));
    if (received) use(frame);
  }
  return absl::OkStatus();
}

}  // namespace

IcubSkin::IcubSkin(SkinPatch patch, const IcubSkinOptions& options)
    : patch_(std::move(patch)), options_(options) {}

std::vector<CanFilter> IcubSkin::Filters() const {
  // Skin data of all boards, and replies to discoveries.
  return {{.id = 0x400, .mask = 0x700}, {.id = 0x700, .mask = 0x70F}};
}

absl::StatusOr<SkinInfo> IcubSkin::Setup(CanBus& bus, Clock& clock) {
  if (options_.period_ms < 1 || options_.period_ms > 255) {
    return InvalidConfig("period_ms", options_.period_ms, "1 to 255");
  }
  remarks_.clear();
  // They may still send, for a host that ended without a word or before a
  // break; answers would have to wait for that.
  TACTUS_RETURN_IF_ERROR(SendAll(bus, false));
  TACTUS_RETURN_IF_ERROR(Discover(bus, clock));
  TACTUS_RETURN_IF_ERROR(ConfigureBoards(bus));
  // Nothing but old scans can come until they are started.
  TACTUS_RETURN_IF_ERROR(
      Listen(bus, clock, options_.settling_ns, [](const CanFrame&) {}));
  TACTUS_RETURN_IF_ERROR(Probe(bus, clock));
  return MaskedInfo();
}

absl::Status IcubSkin::Discover(CanBus& bus, Clock& clock) const {
  std::vector<BoardReply> replies;
  TACTUS_RETURN_IF_ERROR(bus.Send(icub::Discover()));
  TACTUS_RETURN_IF_ERROR(
      Listen(bus, clock, options_.discovery_ns, [&](const CanFrame& frame) {
        if (const auto reply = ReadReply(frame)) replies.push_back(*reply);
      }));
  std::vector<std::string> found;
  for (const BoardReply& reply : replies) {
    found.push_back(absl::StrCat(reply.address));
  }
  const std::string others =
      found.empty() ? "no board does"
                    : "boards that do: " + absl::StrJoin(found, ", ");
  for (const SkinBoard& board : patch_.boards) {
    const auto reply = std::find_if(
        replies.begin(), replies.end(),
        [&](const BoardReply& r) { return r.address == board.address; });
    if (reply == replies.end()) {
      return IoError(bus.name(),
                     absl::StrCat("skin board ", board.address,
                                  " does not answer (", others, ")"));
    }
    if (!reply->application) {
      return IoError(bus.name(),
                     absl::StrCat("board ", board.address,
                                  " runs its bootloader: load its firmware"));
    }
    if (!reply->HasSkin()) {
      return IoError(bus.name(),
                     absl::StrCat("board ", board.address, " is of type ",
                                  reply->type, ", which is no skin board"));
    }
  }
  return absl::OkStatus();
}

absl::Status IcubSkin::ConfigureBoards(CanBus& bus) const {
  for (const SkinBoard& board : patch_.boards) {
    TACTUS_RETURN_IF_ERROR(bus.Send(MakeMessage(
        board.address,
        BoardConfig{.compensation = options_.compensation,
                    .period_ms = static_cast<uint8_t>(options_.period_ms),
                    .no_load = options_.no_load})));
    for (int first = 0; first < kTriangles; ++first) {
      if ((board.triangles >> first & 1) == 0) continue;
      int last = first;
      while (last + 1 < kTriangles && (board.triangles >> (last + 1) & 1)) {
        ++last;
      }
      TACTUS_RETURN_IF_ERROR(bus.Send(MakeMessage(
          board.address,
          TriangleConfig{.first = static_cast<uint8_t>(first),
                         .last = static_cast<uint8_t>(last),
                         .shift = options_.shift,
                         .enabled = true,
                         .converter_offset = options_.converter_offset})));
      first = last;
    }
  }
  return absl::OkStatus();
}

absl::Status IcubSkin::Probe(CanBus& bus, Clock& clock) {
  if (assembler_) earlier_incomplete_ = incomplete();
  assembler_.emplace(patch_.boards, period_ns());
  TACTUS_RETURN_IF_ERROR(SendAll(bus, true));
  TACTUS_RETURN_IF_ERROR(Listen(
      bus, clock, (options_.probe_scans + 1) * period_ns(),
      [this](const CanFrame& frame) { assembler_->Take(frame, scan_); }));
  TACTUS_RETURN_IF_ERROR(SendAll(bus, false));
  // What they had begun to send must be no part of the first scan. A busy host
  // gets it late.
  int64_t frames = 0;
  for (int i = 0; i < kMaxDrains; ++i) {
    const int64_t before = frames;
    TACTUS_RETURN_IF_ERROR(
        Listen(bus, clock, period_ns(), [&](const CanFrame&) { ++frames; }));
    if (frames == before) break;
  }
  std::vector<SkinBoard> heard = patch_.boards;
  std::vector<std::string> remarks;
  uint16_t any = 0;
  for (size_t j = 0; j < heard.size(); ++j) {
    heard[j].triangles &= assembler_->counters(j).heard;
    any |= heard[j].triangles;
    const auto silent =
        static_cast<uint16_t>(patch_.boards[j].triangles & ~heard[j].triangles);
    if (silent == 0) continue;
    remarks.push_back(absl::StrCat("board ", heard[j].address, ": ",
                                   TriangleList(silent),
                                   " masked, because no valid reading came"));
  }
  if (any == 0) {
    return IoError(bus.name(),
                   "the skin boards answer, but no triangle sends a valid "
                   "reading: check the cables between boards and skin");
  }
  remarks_ = absl::StrJoin(remarks, "; ");
  assembler_.emplace(std::move(heard), period_ns());
  return absl::OkStatus();
}

absl::Status IcubSkin::SendAll(CanBus& bus, bool start) const {
  for (const SkinBoard& board : patch_.boards) {
    TACTUS_RETURN_IF_ERROR(bus.Send(MakeTransmit(board.address, start)));
  }
  return absl::OkStatus();
}

SkinInfo IcubSkin::MaskedInfo() const {
  SkinInfo info;
  info.layout = patch_.layout;
  info.taxel_type = v1::TAXEL_TYPE_UINT16;
  info.scale = options_.scale;
  info.sample_rate_hz = 1000.0 / options_.period_ms;
  std::vector<uint8_t>& mask = info.layout.mask;
  // Cells that no value of a valid triangle fills are no taxels.
  std::vector<uint8_t> filled(patch_.layout.taxels(), 0);
  const auto& boards = assembler_->boards();
  for (size_t i = 0; i < patch_.cells.size(); ++i) {
    const auto t = i % kBoardValues / kDots;
    const bool valid = (boards[i / kBoardValues].triangles >> t & 1) != 0;
    if (patch_.cells[i] >= 0 && valid) filled[patch_.cells[i]] = 1;
  }
  if (mask.empty()) mask.assign(patch_.layout.taxels(), 1);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] &= filled[i];
  // As layouts are written: no mask if all are valid.
  if (std::all_of(mask.begin(), mask.end(), [](uint8_t m) { return m != 0; })) {
    mask.clear();
  }
  return info;
}

absl::Status IcubSkin::Start(CanBus& bus) {
  if (assembler_) assembler_->Reset();
  return SendAll(bus, true);
}

absl::Status IcubSkin::Stop(CanBus& bus) { return SendAll(bus, false); }

bool IcubSkin::Take(const CanFrame& can, SkinFrame& frame) {
  if (!assembler_ || !assembler_->Take(can, scan_)) return false;
  frame.capture_time_ns = scan_.start_ns;
  frame.f32.clear();
  frame.u16.assign(patch_.layout.taxels(), 0);
  const auto& boards = assembler_->boards();
  for (size_t i = 0; i < patch_.cells.size(); ++i) {
    const auto t = i % kBoardValues / kDots;
    const bool valid = (boards[i / kBoardValues].triangles >> t & 1) != 0;
    if (patch_.cells[i] < 0 || !valid) continue;
    uint16_t& taxel = frame.u16[patch_.cells[i]];
    taxel = static_cast<uint16_t>(
        std::max(int{taxel}, int{options_.no_load} - int{scan_.raw[i]}));
  }
  return true;
}

uint64_t IcubSkin::incomplete() const {
  uint64_t count = earlier_incomplete_;
  if (!assembler_) return count;
  for (size_t j = 0; j < assembler_->boards().size(); ++j) {
    count += assembler_->counters(j).incomplete;
  }
  return count;
}

std::string IcubSkin::Missing() const {
  if (!assembler_) return "the boards are not configured";
  std::vector<std::string> silent;
  for (size_t j = 0; j < assembler_->boards().size(); ++j) {
    const SkinBoard& board = assembler_->boards()[j];
    const uint16_t heard = assembler_->counters(j).heard_recently;
    const auto lacking = static_cast<uint16_t>(board.triangles & ~heard);
    if (lacking == 0) continue;
    silent.push_back(
        lacking == board.triangles
            ? absl::StrCat("board ", board.address, " sends nothing")
            : absl::StrCat("board ", board.address,
                           " sends no valid reading of ",
                           TriangleList(lacking)));
  }
  return silent.empty() ? "scans are incomplete" : absl::StrJoin(silent, "; ");
}

}  // namespace tactus::internal::client::icub
