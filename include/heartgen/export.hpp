// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Files for other programs: dolfinx, openCARP, Chaste, OpenFOAM and others (`export_formats`), each with a README and,
/// where there are fibres, an input that runs. Not collective; everything throws UserError.
#pragma once
#include "exporters/registry.hpp"
#include "model/error.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen {

using exporters::export_formats;
using exporters::export_mesh;
using exporters::ExportFormat;
using exporters::find_format;

}  // namespace heartgen
