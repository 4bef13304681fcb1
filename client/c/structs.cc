#include "client/c/structs.h"

#include <chrono>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::c {
namespace {

// The numbers of tactus.h are those of the C++ enums.
static_assert(TACTUS_COUNTS == static_cast<int>(SkinUnit::kCounts));
static_assert(TACTUS_FLOAT32 == static_cast<int>(TaxelEncoding::kFloat32));
static_assert(TACTUS_INT16 == static_cast<int>(TaxelEncoding::kInt16));
static_assert(TACTUS_ON_CHANGE == static_cast<int>(Cadence::kOnChange));
static_assert(TACTUS_EVENTS == static_cast<int>(Cadence::kEvents));
static_assert(TACTUS_LOST == static_cast<int>(Contact::State::kLost));
static_assert(TACTUS_MERGED == static_cast<int>(Contact::State::kMerged));
static_assert(TACTUS_RELEASED == static_cast<int>(Contact::State::kReleased));
static_assert(TACTUS_EVENT_DECIDED == static_cast<int>(EventKind::kDecided));
static_assert(TACTUS_EVENT_UNKNOWN == static_cast<int>(EventKind::kUnknown));
static_assert(TACTUS_EVENT_MOVED_OVER_SKIN ==
              static_cast<int>(EventKind::kMovedOverSkin));
static_assert(TACTUS_NOTICE_RATE_DIFFERS ==
              static_cast<int>(Notice::Kind::kRateDiffers));
static_assert(TACTUS_NOTICE_SKIN_DIFFERS ==
              static_cast<int>(Notice::Kind::kSkinDiffers));

// Where the fields of the first TACTUS_ABI 1 end; later ones stand behind.
template <typename Struct>
absl::StatusOr<Struct> CopyIn(absl::string_view what, const Struct& given,
                              const Struct& defaults, size_t least) {
  if (given.struct_size < least || given.struct_size > sizeof(Struct)) {
    return InvalidConfig(
        absl::StrCat(what, ".struct_size"), given.struct_size,
        absl::StrCat("as its ..._INIT sets it, ", least, " to ", sizeof(Struct),
                     " for this library"));
  }
  Struct full = defaults;
  std::memcpy(&full, &given, given.struct_size);
  return full;
}

template <typename Enum>
absl::StatusOr<Enum> EnumFromC(absl::string_view what, int32_t value,
                               Enum last) {
  if (value >= 0 && value <= static_cast<int32_t>(last)) {
    return static_cast<Enum>(value);
  }
  return InvalidConfig(what, value,
                       absl::StrCat("0 to ", static_cast<int32_t>(last)));
}

}  // namespace

absl::StatusOr<Skin> SkinFromC(const tactus_skin& given) {
  TACTUS_ASSIGN_OR_RETURN(const tactus_skin in,
                          CopyIn<tactus_skin>("skin", given, TACTUS_SKIN_INIT,
                                              sizeof(tactus_skin)));
  if (in.name == nullptr) return InvalidConfig("skin.name", "NULL", "given");
  if (in.masked_taxels == nullptr && in.masked_count != 0) {
    return InvalidConfig("skin.masked_taxels", "NULL", "given");
  }
  Skin skin = {.name = in.name,
               .rows = in.rows,
               .columns = in.columns,
               .row_pitch_m = in.row_pitch_m,
               .column_pitch_m = in.column_pitch_m,
               .taxel_area_m2 = in.taxel_area_m2,
               .wrap_columns = in.wrap_columns,
               .contact_threshold = in.contact_threshold,
               .onset_threshold = in.onset_threshold,
               .only_side_neighbours = in.only_side_neighbours,
               .axes = in.axes,
               .signed_values = in.signed_values,
               .scale = in.scale,
               .sample_rate_hz = in.sample_rate_hz,
               .with_poses = in.with_poses};
  TACTUS_ASSIGN_OR_RETURN(skin.unit,
                          EnumFromC("skin.unit", in.unit, SkinUnit::kCounts));
  TACTUS_ASSIGN_OR_RETURN(skin.encoding, EnumFromC("skin.encoding", in.encoding,
                                                   TaxelEncoding::kInt16));
  if (in.masked_count != 0) {
    skin.masked_taxels.assign(in.masked_taxels,
                              in.masked_taxels + in.masked_count);
  }
  if (in.normal_axis != -1) skin.normal_axis = in.normal_axis;
  if (in.light_window_s != 0) {
    skin.light_touch = {.window_s = in.light_window_s,
                        .rows = in.light_rows,
                        .columns = in.light_columns,
                        .contact_threshold = in.light_contact_threshold,
                        .onset_threshold = in.light_onset_threshold};
  }
  return skin;
}

absl::StatusOr<StreamOptions> OptionsFromC(const tactus_options& given) {
  TACTUS_ASSIGN_OR_RETURN(
      const tactus_options in,
      CopyIn<tactus_options>("options", given, TACTUS_OPTIONS_INIT,
                             sizeof(tactus_options)));
  StreamOptions options = {.interval_frames = in.interval_frames,
                           .never_release = in.never_release,
                           .low_effort = in.low_effort,
                           .with_taxels = in.with_taxels};
  TACTUS_ASSIGN_OR_RETURN(
      options.cadence,
      EnumFromC("options.cadence", in.cadence, Cadence::kEvents));
  if (in.decision_threshold != 0) {
    options.decision_threshold = in.decision_threshold;
  }
  if (in.decision_frames != 0) options.decision_frames = in.decision_frames;
  if (in.release_after_ms != 0) {
    options.release_after = std::chrono::milliseconds(in.release_after_ms);
  }
  if (in.max_contacts != 0) options.max_contacts = in.max_contacts;
  return options;
}

absl::Status FrameFromC(const tactus_frame& given, Frame& frame) {
  TACTUS_ASSIGN_OR_RETURN(
      const tactus_frame in,
      CopyIn<tactus_frame>("frame", given, TACTUS_FRAME_INIT,
                           sizeof(tactus_frame)));
  frame.capture_time_ns = in.capture_time_ns;
  frame.missing_before = in.missing_before;
  frame.values.assign(in.values, in.values + in.count);
  frame.pose = {.x = in.pose.x,
                .y = in.pose.y,
                .z = in.pose.z,
                .qx = in.pose.qx,
                .qy = in.pose.qy,
                .qz = in.pose.qz,
                .qw = in.pose.qw};
  return absl::OkStatus();
}

}  // namespace tactus::internal::c
