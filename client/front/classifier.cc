#include "tactus/classifier.h"

#include <utility>

#include "absl/strings/string_view.h"
#include "client/front/local_stream.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/files/file_bytes.h"

namespace tactus {

class Classifier::Impl {
 public:
  explicit Impl(internal::client::LocalModel model)
      : model_(std::move(model)) {}

  const internal::client::LocalModel& model() const { return model_; }

 private:
  const internal::client::LocalModel model_;
};

absl::StatusOr<Classifier> Classifier::Load(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      internal::ReadFileBytes(path, internal::limits::kMaxBundleBytes));
  return Parse(bytes, path);
}

absl::StatusOr<Classifier> Classifier::Parse(std::string_view file,
                                             const std::string& name) {
  const absl::string_view bytes(file.data(), file.size());
  internal::client::LocalModel model = {
      .model = nullptr,
      .version = name,
      .sha256 = internal::BundleSha256(bytes)};
  auto decoded = internal::DecodeBundle(bytes);
  if (!decoded.ok()) return internal::Annotate(decoded.status(), name);
  model.model = *std::move(decoded);
  const absl::Status same = internal::RunWarmUp(*model.model);
  if (!same.ok()) return internal::Annotate(same, name);
  return Classifier(std::make_unique<const Impl>(std::move(model)));
}

Classifier::Classifier(std::unique_ptr<const Impl> impl)
    : impl_(std::move(impl)) {}
Classifier::~Classifier() = default;
Classifier::Classifier(Classifier&&) noexcept = default;
Classifier& Classifier::operator=(Classifier&&) noexcept = default;

absl::StatusOr<std::unique_ptr<Stream>> Classifier::Open(
    const Skin& skin, const StreamOptions& options) const {
  return internal::client::OpenLocalStream(impl_->model(), skin, options);
}

}  // namespace tactus
