// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What comes with an export beside the mesh: a page that says what was written, and the smallest input that runs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "exporters/registry.hpp"

namespace heartgen::exporters {

/// Writes NAME_README.md, and the files of exporters/decks/ for this format: those in muscle/ where the mesh has
/// ventricles with fibres, in heart/ where it has nothing else, in torso/ where it has other tissue too. Returns the
/// files written.
std::vector<std::filesystem::path> write_deck(const ExportFormat& format, const ExportTask& task);

/// A node of the left ventricle's endocardium at the middle of the septum, where decks stimulate; in a mesh without
/// septum another node of its muscle.
Vec3 septal_site(const TetMesh& mesh);

/// The stimulated site's domain in svMultiPhysics, which keeps domains as bits of a 32-bit integer (set_dmn_id_ff in
/// its read_msh.cpp, btest in utils.cpp): a number above 31 is another domain's bit, or none. Regions have those below.
constexpr std::int32_t stimulus_domain = 30;

}  // namespace heartgen::exporters
