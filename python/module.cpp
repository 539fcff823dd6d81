// SPDX-License-Identifier: GPL-3.0-or-later
#include "module.hpp"

#include <heartgen/pde.hpp>
#include <heartgen/version.hpp>
#include <new>

#include "arrays.hpp"

namespace {

namespace py = pybind11;

/// UserError as heartgen.Error with its three parts; a lack of memory as MemoryError; what is no directory as OSError.
void translate_errors(const py::object& error_type) {
  static const py::handle type = py::object(error_type).release();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const heartgen::UserError& error) {
      py::object raised = type(error.message);
      raised.attr("problem") = error.problem;
      raised.attr("where") = error.where;
      raised.attr("remedy") = error.remedy;
      PyErr_SetObject(type.ptr(), raised.ptr());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.attr("version") = HEARTGEN_VERSION;
  const auto error = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc("heartgen.Error", "What is wrong (problem), where, and what to do about it (remedy).",
                                PyExc_ValueError, nullptr));
  m.attr("Error") = error;
  translate_errors(error);
  m.def("set_threads", &heartgen::parallel::set_thread_count);
  m.def("threads", &heartgen::parallel::thread_count);
  heartgen::python::add_images(m);
  heartgen::python::add_meshes(m);
  heartgen::python::add_bundles(m);
}
