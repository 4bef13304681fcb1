// The module tactus._native: LocalModel and LocalSession for Python.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "client/python/native/local_session.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal::python {
namespace {

namespace py = pybind11;

// A serialised v1::Status, as Python's errors read it.
std::string ToBytes(const absl::Status& status) {
  v1::Status message;
  message.set_code(static_cast<int>(status.code()));
  message.set_message(std::string(status.message()));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    google::protobuf::Any* detail = message.add_details();
    detail->set_type_url(std::string(type));
    detail->set_value(std::string(payload));
  });
  return message.SerializeAsString();
}

py::object Failure(const absl::Status& status) {
  if (status.ok()) return py::none();
  return py::bytes(ToBytes(status));
}

// A pair of what was made and of None, or of None and the error.
template <typename Made>
py::tuple Pair(absl::StatusOr<Made> made) {
  if (!made.ok()) return py::make_tuple(py::none(), Failure(made.status()));
  return py::make_tuple(py::cast(*std::move(made)), py::none());
}

py::tuple Load(const std::string& path) {
  absl::StatusOr<std::shared_ptr<const LocalModel>> made;
  {
    const py::gil_scoped_release released;
    made = LocalModel::Load(path);
  }
  if (!made.ok()) return py::make_tuple(py::none(), Failure(made.status()));
  return py::make_tuple(std::const_pointer_cast<LocalModel>(*made), py::none());
}

py::tuple Open(const std::shared_ptr<LocalModel>& model,
               const std::string& config) {
  return Pair(LocalSession::Open(model, config));
}

// The error, or None, and the responses.
py::tuple Exchange(LocalSession& session, const py::bytes& request) {
  absl::Status status;
  std::vector<std::string> responses;
  // The bytes do not change, and the caller holds them.
  char* data = nullptr;
  Py_ssize_t size = 0;
  if (PyBytes_AsStringAndSize(request.ptr(), &data, &size) != 0) {
    throw py::error_already_set();
  }
  {
    const py::gil_scoped_release released;
    status = session.Take({data, static_cast<size_t>(size)});
    responses = session.TakeResponses();
  }
  py::list list;
  for (const std::string& response : responses)
    list.append(py::bytes(response));
  return py::make_tuple(Failure(status), list);
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  py::class_<LocalModel, std::shared_ptr<LocalModel>>(module, "Model")
      .def_readonly("path", &LocalModel::path)
      .def_readonly("sha256", &LocalModel::sha256);
  py::class_<LocalSession>(module, "Session")
      .def("started",
           [](const LocalSession& session) {
             return py::bytes(session.started());
           })
      .def("exchange", &Exchange);
  module.def("load", &Load);
  module.def("open", &Open);
}

}  // namespace tactus::internal::python
