// The module tactus._native: LocalModel, LocalSession and LocalFit for Python.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "client/python/native/local_fit.h"
#include "client/python/native/local_session.h"
#include "core/skin/layout_proto.h"
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

py::tuple Loaded(
    const absl::StatusOr<std::shared_ptr<const LocalModel>>& made) {
  if (!made.ok()) return py::make_tuple(py::none(), Failure(made.status()));
  return py::make_tuple(std::const_pointer_cast<LocalModel>(*made), py::none());
}

py::tuple Load(const std::string& path) {
  absl::StatusOr<std::shared_ptr<const LocalModel>> made;
  {
    const py::gil_scoped_release released;
    made = LocalModel::Load(path);
  }
  return Loaded(made);
}

py::tuple Decode(const std::string& bundle, const std::string& path) {
  absl::StatusOr<std::shared_ptr<const LocalModel>> made;
  {
    const py::gil_scoped_release released;
    made = LocalModel::Decode(bundle, path);
  }
  return Loaded(made);
}

py::bytes GeometryOf(const LocalModel& model) {
  return LayoutToProto(model.model->model().layout).SerializeAsString();
}

// The bytes of a C-contiguous array, which stay where they are.
class View {
 public:
  explicit View(const py::handle& array) {
    if (PyObject_GetBuffer(array.ptr(), &view_, PyBUF_SIMPLE) != 0) {
      throw py::error_already_set();
    }
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  ~View() { PyBuffer_Release(&view_); }

  absl::string_view bytes() const {
    return {static_cast<const char*>(view_.buf),
            static_cast<size_t>(view_.len)};
  }

 private:
  Py_buffer view_;
};

// How often signals are looked at and progress is shown.
constexpr auto kShowEvery = std::chrono::milliseconds(100);

// A pair of the bundle and of None, or of None and the error. The training runs
// on other threads, because Python handles signals on the calling thread alone.
// `progress` is called with the phase and its fraction; what it raises, or a
// signal's handler does, ends the training and is raised.
py::tuple Fit(const py::list& trials, const std::string& spec, int threads,
              const std::string& command, const std::string& data,
              const py::function& progress) {
  std::vector<std::unique_ptr<View>> views;
  std::vector<BorrowedTrial> borrowed;
  for (const py::handle& item : trials) {
    const auto pair = py::cast<py::tuple>(item);
    views.push_back(std::make_unique<View>(pair[1]));
    borrowed.push_back({py::cast<std::string>(pair[0]), views.back()->bytes()});
  }
  LocalFit fit(spec, {.threads = threads, .command = command, .data = data});
  auto running =
      std::async(std::launch::async, [&] { return fit.Run(borrowed); });
  const auto ended = [&](std::chrono::milliseconds wait) {
    const py::gil_scoped_release released;
    return running.wait_for(wait) == std::future_status::ready;
  };
  try {
    while (!ended(kShowEvery)) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const auto [phase, fraction] = fit.Done();
      progress(phase, fraction);
    }
  } catch (...) {
    fit.Cancel();
    const py::gil_scoped_release released;
    running.wait();
    throw;
  }
  const absl::StatusOr<std::string> bundle = running.get();
  if (!bundle.ok()) return py::make_tuple(py::none(), Failure(bundle.status()));
  return py::make_tuple(py::bytes(*bundle), py::none());
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
      .def_readonly("sha256", &LocalModel::sha256)
      .def_property_readonly("geometry", &GeometryOf)
      .def_property_readonly(
          "rate_hz",
          [](const LocalModel& model) {
            return model.model->model().inputs.sample_rate_hz;
          })
      .def_property_readonly("classes",
                             [](const LocalModel& model) {
                               return model.model->model().class_names;
                             })
      .def_property_readonly("note", [](const LocalModel& model) {
        return model.model->model().provenance.note;
      });
  py::class_<LocalSession>(module, "Session")
      .def("started",
           [](const LocalSession& session) {
             return py::bytes(session.started());
           })
      .def("exchange", &Exchange);
  module.def("load", &Load);
  module.def("decode", &Decode);
  module.def("fit", &Fit);
  module.def("open", &Open);
}

}  // namespace tactus::internal::python
