#include "client/ros2/raw_type.h"

#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "absl/strings/string_view.h"
#include "core/base/limits_bags.h"
#include "dds/ddsi/ddsi_serdata.h"
#include "dds/ddsi/q_radmin.h"

namespace tactus::internal::client {
namespace {

// Messages begin with the name of their encoding.
constexpr size_t kEncodingBytes = 4;

struct RawMessage : ddsi_serdata {
  RawMessage(const ddsi_sertype* type, ddsi_serdata_kind kind, size_t size)
      : ddsi_serdata(), bytes((size + 3) / 4 * 4, '\0'), size(size) {
    ddsi_serdata_init(this, type, kind);
    // No type has a key, so all messages are of one instance.
    hash = type->serdata_basehash;
  }

  // Cyclone DDS sends whole words.
  std::string bytes;
  size_t size;
};

const RawMessage& Raw(const ddsi_serdata* message) {
  return *static_cast<const RawMessage*>(message);
}

bool IsSize(size_t size) {
  return size >= kEncodingBytes && size <= limits::kMaxBagMessageBytes;
}

ddsi_serdata* MakeMessage(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          absl::string_view bytes) {
  if (!IsSize(bytes.size())) return nullptr;
  auto message = std::make_unique<RawMessage>(type, kind, bytes.size());
  std::memcpy(message->bytes.data(), bytes.data(), bytes.size());
  return message.release();
}

// Fragments rise, and may overlap.
ddsi_serdata* FromFragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                            const nn_rdata* fragment, size_t size) {
  if (!IsSize(size)) return nullptr;
  auto message = std::make_unique<RawMessage>(type, kind, size);
  size_t done = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= done) continue;
    if (fragment->min > done || fragment->maxp1 > size) return nullptr;
    const unsigned char* const payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(message->bytes.data() + done, payload + (done - fragment->min),
                fragment->maxp1 - done);
    done = fragment->maxp1;
  }
  return done == size ? message.release() : nullptr;
}

ddsi_serdata* FromParts(const ddsi_sertype* type, ddsi_serdata_kind kind,
                        ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* parts,
                        size_t size) {
  std::string bytes;
  for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
    bytes.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  }
  return bytes.size() < size
             ? nullptr
             : MakeMessage(type, kind,
                           absl::string_view(bytes).substr(0, size));
}

ddsi_serdata* ToReference(const ddsi_serdata* message, size_t from, size_t size,
                          ddsrt_iovec_t* part) {
  part->iov_base = const_cast<char*>(Raw(message).bytes.data()) + from;
  part->iov_len = size;
  return ddsi_serdata_ref(message);
}

ddsi_serdata* ToUntyped(const ddsi_serdata* message) {
  auto* const key = new RawMessage(message->type, SDK_KEY, kEncodingBytes);
  key->type = nullptr;
  return key;
}

bool ToSample(const ddsi_serdata* message, void* sample, void**, void*) {
  const RawMessage& raw = Raw(message);
  static_cast<std::string*>(sample)->assign(raw.bytes, 0, raw.size);
  return true;
}

constexpr ddsi_serdata_ops kMessageOps = {
    .eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; },
    .get_size =
        [](const ddsi_serdata* message) {
          return static_cast<uint32_t>(Raw(message).size);
        },
    .from_ser = FromFragments,
    .from_ser_iov = FromParts,
    .from_keyhash = [](const ddsi_sertype* type,
                       const ddsi_keyhash*) -> ddsi_serdata* {
      return new RawMessage(type, SDK_KEY, kEncodingBytes);
    },
    .from_sample =
        [](const ddsi_sertype* type, ddsi_serdata_kind kind,
           const void* sample) {
          return MakeMessage(type, kind,
                             *static_cast<const absl::string_view*>(sample));
        },
    .to_ser =
        [](const ddsi_serdata* message, size_t from, size_t size, void* out) {
          std::memcpy(out, Raw(message).bytes.data() + from, size);
        },
    .to_ser_ref = ToReference,
    .to_ser_unref = [](ddsi_serdata* message,
                       const ddsrt_iovec_t*) { ddsi_serdata_unref(message); },
    .to_sample = ToSample,
    .to_untyped = ToUntyped,
    .untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*,
                            void**, void*) { return true; },
    .free =
        [](ddsi_serdata* message) { delete static_cast<RawMessage*>(message); },
    .print =
        [](const ddsi_sertype*, const ddsi_serdata* message, char* out,
           size_t size) {
          const int length =
              std::snprintf(out, size, "%zu bytes", Raw(message).size);
          return std::min(static_cast<size_t>(length), size - 1);
        },
    .get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash,
                      bool) { std::memset(hash, 0, sizeof(*hash)); },
    // Shared memory is for types of a fixed size.
    .get_sample_size = nullptr,
    .from_iox_buffer = nullptr};

std::string* Samples(void* samples) {
  return static_cast<std::string*>(samples);
}

constexpr ddsi_sertype_ops kTypeOps = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free =
        [](ddsi_sertype* type) {
          ddsi_sertype_fini(type);
          delete type;
        },
    .zero_samples =
        [](const ddsi_sertype*, void* samples, size_t count) {
          for (size_t i = 0; i < count; ++i) Samples(samples)[i].clear();
        },
    // Nobody takes loans.
    .realloc_samples =
        [](void** pointers, const ddsi_sertype*, void*, size_t, size_t count) {
          std::fill_n(pointers, count, nullptr);
        },
    .free_samples = [](const ddsi_sertype*, void**, size_t, dds_free_op_t) {},
    .equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; },
    .hash = [](const ddsi_sertype*) { return uint32_t{0}; },
    // Readers and writers match by the type's name, as those of ROS 2 do.
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr};

}  // namespace

ddsi_sertype* MakeRawType(const std::string& name) {
  auto* const type = new ddsi_sertype();
  ddsi_sertype_init_flags(type, name.c_str(), &kTypeOps, &kMessageOps,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  return type;
}

}  // namespace tactus::internal::client
