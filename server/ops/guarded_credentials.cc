#include "server/ops/guarded_credentials.h"

#include <malloc.h>

#include <chrono>
#include <typeinfo>

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"
#include "grpc/grpc.h"
#include "grpcpp/security/auth_metadata_processor.h"
#include "server/ops/clock.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

constexpr char kTooMany[] =
    "calls arrive faster than the server takes them; try again later";
// Calls that wait for the refuser's thread: bounded, because each keeps its
// memory until then.
constexpr size_t kMostCallsOfRefuser = 64;
constexpr int64_t kLogEveryNs = 1'000'000'000;
// How often it is checked whether the allocator holds more free memory than
// before, and how much more it may hold.
constexpr std::chrono::seconds kTrimEvery(2);
constexpr size_t kMostFreeBytes = 16 * 1024 * 1024;

constexpr char kUnknown[] = "the server has no such service";
// The services whose calls our threads request.
constexpr absl::string_view kRequested[] = {
    "/tactus.v1.ContactService/",  "/grpc.health.v1.Health/",
    "/tactus.v1.TrainingService/", "/tactus.v1.OperationService/",
    "/tactus.v1.ModelService/",    "/tactus.v1.AdminService/",
    "/tactus.v1.MonitorService/",  "/tactus.v1.ContactLogService/"};

// Calls of unknown services end here too: gRPC would queue them first.
grpc_status_code Admit(absl::string_view path, const Guards& guards) {
  for (const absl::string_view service : kRequested) {
    if (!absl::StartsWith(path, service)) continue;
    return guards.gate->TryEnter(MonotonicNs())
               ? GRPC_STATUS_OK
               : GRPC_STATUS_RESOURCE_EXHAUSTED;
  }
  // Its calls have threads of gRPC's own, whose number is limited.
  return guards.reflection && absl::StartsWith(path, "/grpc.reflection.")
             ? GRPC_STATUS_OK
             : GRPC_STATUS_UNIMPLEMENTED;
}

absl::string_view View(const grpc_slice& slice) {
  return absl::string_view(
      reinterpret_cast<const char*>(GRPC_SLICE_START_PTR(slice)),
      GRPC_SLICE_LENGTH(slice));
}

void Process(void* state, grpc_auth_context*, const grpc_metadata* metadata,
             size_t count, grpc_process_auth_metadata_done_cb done,
             void* call) {
  const Guards& guards = *static_cast<Guards*>(state);
  absl::string_view path;
  for (size_t i = 0; i < count; ++i) {
    if (View(metadata[i].key) == ":path") path = View(metadata[i].value);
  }
  const grpc_status_code status = Admit(path, guards);
  if (status == GRPC_STATUS_RESOURCE_EXHAUSTED) {
    guards.refuser->Refuse(done, call);
  } else {
    done(call, nullptr, 0, nullptr, 0, status,
         status == GRPC_STATUS_OK ? nullptr : kUnknown);
  }
}

// grpc::InsecureServerCredentials takes no processor; the credentials of
// gRPC's core that it stands for do.
class PlainCredentials final : public grpc::ServerCredentials {
 public:
  explicit PlainCredentials(const Guards& guards) : guards_(guards) {}
  void SetAuthMetadataProcessor(
      const std::shared_ptr<grpc::AuthMetadataProcessor>&) override {}

 private:
  int AddPortToServer(const std::string& address,
                      grpc_server* server) override {
    grpc_server_credentials* plain = grpc_insecure_server_credentials_create();
    grpc_auth_metadata_processor processor = {};
    processor.process = Process;
    processor.state = new Guards(guards_);
    processor.destroy = [](void* state) { delete static_cast<Guards*>(state); };
    grpc_server_credentials_set_auth_metadata_processor(plain, processor);
    const int port = grpc_server_add_http2_port(server, address.c_str(), plain);
    grpc_server_credentials_release(plain);
    return port;
  }

  const Guards guards_;
};

// The same for credentials of the C++ library.
class Processor final : public grpc::AuthMetadataProcessor {
 public:
  explicit Processor(const Guards& guards) : guards_(guards) {}
  bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext*,
                       OutputMetadata*, OutputMetadata*) override {
    const auto path = metadata.find(":path");
    const absl::string_view name =
        path == metadata.end()
            ? ""
            : absl::string_view(path->second.data(), path->second.size());
    switch (Admit(name, guards_)) {
      case GRPC_STATUS_OK:
        return grpc::Status::OK;
      case GRPC_STATUS_UNIMPLEMENTED:
        return {grpc::StatusCode::UNIMPLEMENTED, kUnknown};
      default:
        return {grpc::StatusCode::RESOURCE_EXHAUSTED, kTooMany};
    }
  }

 private:
  const Guards guards_;
};

// The allocator keeps what a flood has used; the system gets it back here.
// `free_bytes` is what was free the last time.
void GiveBackMemory(size_t* free_bytes) {
  size_t now = mallinfo2().fordblks;
  if (now > *free_bytes + kMostFreeBytes) {
    malloc_trim(0);
    now = mallinfo2().fordblks;
  }
  *free_bytes = now;
}

}  // namespace

CallRefuser::CallRefuser(const ArrivalGate* gate)
    : gate_(gate), thread_([this] { Run(); }) {}

CallRefuser::~CallRefuser() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void CallRefuser::Refuse(grpc_process_auth_metadata_done_cb done, void* call) {
  {
    const std::lock_guard lock(mutex_);
    if (calls_.size() < kMostCallsOfRefuser) {
      calls_.emplace_back(done, call);
      call = nullptr;
    }
  }
  if (call == nullptr) {
    wake_.notify_one();
  } else {
    done(call, nullptr, 0, nullptr, 0, GRPC_STATUS_RESOURCE_EXHAUSTED,
         kTooMany);
  }
}

void CallRefuser::Run() {
  std::vector<std::pair<grpc_process_auth_metadata_done_cb, void*>> calls;
  int64_t logged_ns = 0;
  uint64_t logged = 0;
  size_t free_bytes = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    const auto woken = [this] { return stopping_ || !calls_.empty(); };
    if (!wake_.wait_for(lock, kTrimEvery, woken)) {
      lock.unlock();
      GiveBackMemory(&free_bytes);
      lock.lock();
      continue;
    }
    if (calls_.empty()) return;
    calls.swap(calls_);
    lock.unlock();
    for (const auto& [done, call] : calls) {
      done(call, nullptr, 0, nullptr, 0, GRPC_STATUS_RESOURCE_EXHAUSTED,
           kTooMany);
    }
    calls.clear();
    if (const int64_t now_ns = MonotonicNs();
        now_ns - logged_ns > kLogEveryNs) {
      const uint64_t refused = gate_->refused();
      spdlog::warn("refused {} calls: {}", refused - logged, kTooMany);
      logged_ns = now_ns;
      logged = refused;
    }
    lock.lock();
  }
}

std::shared_ptr<grpc::ServerCredentials> Guard(
    std::shared_ptr<grpc::ServerCredentials> credentials,
    const Guards& guards) {
  const auto plain = grpc::InsecureServerCredentials();
  const grpc::ServerCredentials& given = *credentials;
  const grpc::ServerCredentials& insecure = *plain;
  if (typeid(given) == typeid(insecure)) {
    return std::make_shared<PlainCredentials>(guards);
  }
  credentials->SetAuthMetadataProcessor(std::make_shared<Processor>(guards));
  return credentials;
}

}  // namespace tactus::internal::server
