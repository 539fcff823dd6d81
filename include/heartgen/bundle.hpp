// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Model bundles on disk: what is in one, its meshes, whether it is whole, one file of it. Not collective; everything
/// throws UserError.
#pragma once
#include "exporters/bundle.hpp"
#include "exporters/certificate_json.hpp"
#include "model/error.hpp"

namespace heartgen {
namespace bundle {

using exporters::certificate_json;
using exporters::Manifest;
using exporters::ManifestMesh;
using exporters::pack_bundle;
using exporters::Problem;
using exporters::read_certificate;
using exporters::read_labels;
using exporters::read_manifest;
using exporters::read_mesh;
using exporters::sha256_of_file;
using exporters::unpack_bundle;
using exporters::verify_bundle;

/// All meshes by name.
std::map<std::string, TetMesh> read_meshes(const std::filesystem::path& folder);

}  // namespace bundle
}  // namespace heartgen
