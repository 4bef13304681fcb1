#include "core/bundle/bundle.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/wire_check.h"
#include "core/bundle/field_count.h"
#include "core/bundle/model_proto.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "bundle numbers are little-endian");

constexpr absl::string_view kMagic = "TACTUSMB";
constexpr size_t kVersionOffset = 8;
constexpr size_t kLengthOffset = 12;
constexpr size_t kPayloadOffset = 20;
constexpr size_t kDigestBytes = Sha256::kBytes;

template <typename Number>
void AppendNumber(Number value, std::string& out) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

template <typename Number>
Number ReadNumber(absl::string_view bytes, size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The payload of a bundle whose envelope and checksum are right.
absl::StatusOr<absl::string_view> OpenEnvelope(absl::string_view bytes) {
  if (bytes.size() > limits::kMaxBundleBytes) {
    return BundleCorrupt(absl::StrCat("it has ", bytes.size(),
                                      " bytes; the limit is ",
                                      limits::kMaxBundleBytes));
  }
  if (bytes.size() < kPayloadOffset + kDigestBytes) {
    return BundleCorrupt(absl::StrCat("it has ", bytes.size(),
                                      " bytes, too few for an envelope"));
  }
  if (!absl::StartsWith(bytes, kMagic)) {
    return BundleCorrupt("it does not begin with TACTUSMB");
  }
  const absl::string_view body = BundleBody(bytes);
  if (Sha256Of(body) != bytes.substr(body.size())) {
    return BundleCorrupt("its SHA-256 checksum does not match");
  }
  const auto version = ReadNumber<uint32_t>(bytes, kVersionOffset);
  if (version < kBundleFormatVersion ||
      version > kBundleFormatVersionComponents) {
    return BundleVersion(version, kBundleFormatVersionComponents);
  }
  const absl::string_view payload = body.substr(kPayloadOffset);
  if (ReadNumber<uint64_t>(bytes, kLengthOffset) != payload.size()) {
    return BundleCorrupt("its payload length does not match");
  }
  return payload;
}

}  // namespace

uint32_t BundleFormatVersion(const Model& model) {
  const auto has_auxiliary = [](const SkinLayout& layout) {
    return !layout.auxiliary.empty();
  };
  if (NeedsComponents(model) || has_auxiliary(model.layout) ||
      std::ranges::any_of(model.more_layouts, has_auxiliary)) {
    return kBundleFormatVersionComponents;
  }
  if (!HasHmms(model) || model.calibration.hold_after_frames > 0) {
    return kBundleFormatVersionRecordings;
  }
  const auto has_hidden = [](const LstmNetwork& network) {
    return !network.hidden.empty();
  };
  return std::ranges::any_of(model.lstms, has_hidden) ||
                 (model.estimator && has_hidden(*model.estimator))
             ? kBundleFormatVersionHidden
             : kBundleFormatVersion;
}

absl::StatusOr<std::string> EncodeBundle(const Model& model) {
  TACTUS_RETURN_IF_ERROR(CompiledModel::Create(model).status());
  const std::string payload = SerializeDeterministic(ModelToProto(model));
  std::string bytes(kMagic);
  AppendNumber<uint32_t>(BundleFormatVersion(model), bytes);
  AppendNumber<uint64_t>(payload.size(), bytes);
  bytes += payload;
  bytes += Sha256Of(bytes);
  return bytes;
}

absl::StatusOr<std::shared_ptr<const CompiledModel>> DecodeBundle(
    absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const absl::string_view payload, OpenEnvelope(bytes));
  v1::ModelBundle message;
  if (!HasAtMostFields(*message.GetDescriptor(), payload,
                       limits::kMaxBundleFields)) {
    return BundleCorrupt(absl::StrCat("its payload has more than ",
                                      limits::kMaxBundleFields,
                                      " fields or is cut short"));
  }
  if (!message.ParseFromArray(payload.data(),
                              static_cast<int>(payload.size()))) {
    return BundleCorrupt("its payload is not a tactus.v1.ModelBundle");
  }
  TACTUS_ASSIGN_OR_RETURN(Model model, ModelFromProto(message));
  return CompiledModel::Create(std::move(model));
}

absl::Status CheckBundleFields(absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const absl::string_view payload, OpenEnvelope(bytes));
  const WireCheck check = CheckWire(*v1::ModelBundle::descriptor(), payload);
  if (check.fault.empty()) return absl::OkStatus();
  return BundleCorrupt(absl::StrCat("its payload: ", check.fault));
}

std::string BundleSha256(absl::string_view bytes) {
  if (bytes.size() < kDigestBytes) return "";
  return absl::BytesToHexString(bytes.substr(bytes.size() - kDigestBytes));
}

absl::string_view BundleBody(absl::string_view bytes) {
  return bytes.substr(0, bytes.size() - std::min(bytes.size(), kDigestBytes));
}

}  // namespace tactus::internal
