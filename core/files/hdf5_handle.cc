#include "core/files/hdf5_handle.h"

namespace tactus::internal {
namespace {

herr_t TakeFirst(unsigned, const H5E_error2_t* error, void* out) {
  std::string& text = *static_cast<std::string*>(out);
  if (text.empty() && error->desc != nullptr) text = error->desc;
  return 0;
}

}  // namespace

bool Hdf5Handle::Close() {
  if (id_ < 0) return true;
  return closer_(std::exchange(id_, H5I_INVALID_HID)) >= 0;
}

Hdf5Quiet::Hdf5Quiet() {
  // All handles are closed by their owners. HDF5's own clean-up at exit loops
  // (and says so) over what it kept of damaged files.
  static const herr_t kNoExitHandler = H5dont_atexit();
  static_cast<void>(kNoExitHandler);
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Quiet::~Hdf5Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

std::string Hdf5LastError() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, TakeFirst, &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

}  // namespace tactus::internal
