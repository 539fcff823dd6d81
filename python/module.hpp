// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the module heartgen._native. What users call, and its documentation, is in heartgen/*.py.
#pragma once
#include <pybind11/pybind11.h>

namespace heartgen::python {

void add_images(pybind11::module_& m);
void add_meshes(pybind11::module_& m);
void add_bundles(pybind11::module_& m);

}  // namespace heartgen::python
