// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A model bundle on disk: write, read, check. Layout and manifest as the bundle's own README.md explains them.
/// The content id covers the manifest, all but its inputs and tools, and so every file but logs/*.log.
/// Nothing that it covers holds a time stamp, host name or absolute path. Not collective; call on one rank.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "exporters/reserved_place.hpp"
#include "model/certificate.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::exporters {

/// Throws UserError where a file or folder that is to be written would lie in a bundle's folder: with it the bundle
/// would no longer be what its manifest says.
void refuse_inside(const std::filesystem::path& output, const std::filesystem::path& bundle);

/// A file that went into the build: CT, atlas, landmarks ...
struct BundleInput {
  std::string name;  ///< what it was used as and its file name: "ct: patient.nii.gz"; never a path
  std::string sha256;
  std::int64_t bytes = 0;
  friend bool operator==(const BundleInput&, const BundleInput&) = default;
};

/// What a build hands over.
struct Bundle {
  std::string name;
  std::string version;
  std::string license;  ///< SPDX identifier
  std::string author;
  std::string attribution;               ///< of the data the model is made from; may be empty
  std::string date_published;            ///< YYYY-MM-DD from the recipe; may be empty
  std::string recipe;                    ///< recipe.toml with every default, input folders dropped
  std::string atlas;                     ///< one sentence on where the fibres come from; empty: no fibres
  std::vector<double> torso_from_heart;  ///< pose in another patient's torso, 3 rows of 4 numbers; empty: its own
  LabelVolume labels;
  std::map<std::string, TetMesh> meshes;  ///< "myocardium", "torso" ...
  Certificate certificate;
  std::string report_html;
  std::vector<BundleInput> inputs;
  std::map<std::string, std::string> tools;  ///< library: version
  std::map<std::string, std::string> logs;   ///< file name: text; outside the content id
};

struct ManifestCavity {
  std::string blood;              ///< name of its region
  double volume_ml = 0;           ///< inside of its faces
  std::vector<std::string> caps;  ///< sorted
  friend bool operator==(const ManifestCavity&, const ManifestCavity&) = default;
};

struct ManifestMesh {
  std::string file;          ///< meshes/NAME.vtu
  std::string surface_file;  ///< surfaces/NAME.vtp
  std::string curve_file;    ///< curves/NAME.vtp; empty in bundles of before
  std::int64_t nodes = 0;
  std::int64_t cells = 0;
  std::int64_t faces = 0;
  std::map<std::string, std::int64_t> regions;       ///< name: cells
  std::map<std::string, std::int64_t> surfaces;      ///< name: faces
  std::map<std::string, std::int64_t> rims;          ///< name: nodes
  std::map<std::string, std::int64_t> curves;        ///< name: edges
  std::map<std::string, std::int64_t> user_regions;  ///< name: cells that count for it; not written where empty
  std::string cavity_file;                           ///< cavities/NAME.vtp; empty without cavities
  std::map<std::string, ManifestCavity> cavities;    ///< by name
  friend bool operator==(const ManifestMesh&, const ManifestMesh&) = default;
};

struct ManifestFile {
  std::string path;  ///< relative to the bundle, with '/'
  std::string sha256;
  std::int64_t bytes = 0;
  friend bool operator==(const ManifestFile&, const ManifestFile&) = default;
};

/// manifest.json
struct Manifest {
  std::string schema, name, version, license, author, attribution, date_published, content_id, unit, frame, atlas;
  std::map<std::string, std::int32_t> regions;             ///< name: tag, those that occur in a mesh
  std::map<std::string, std::int32_t> surfaces;            ///< name: tag
  std::map<std::string, std::int32_t> rims;                ///< name: tag
  std::map<std::string, std::int32_t> user_regions, caps;  ///< name: tag; not written where empty
  std::map<std::string, ManifestMesh> meshes;
  std::vector<ManifestFile> files;  ///< sorted by path; without manifest.json and logs/
  std::vector<BundleInput> inputs;
  std::map<std::string, std::string> tools;
  std::vector<double> torso_from_heart;  ///< as in Bundle; not written where empty
  std::vector<Warning> warnings;         ///< of the certificate
  std::vector<UseVerdict> uses;
};

/// Throws UserError where a bundle cannot have that name or version: both are part of an archive's folder name.
void require_safe_names(const std::string& name, const std::string& version);

/// Writes a bundle and returns its content id. The files are written into a sibling folder that takes the place of
/// `folder` at the end, so that no half-written bundle ever stands there. Throws UserError as reserve_place does, or
/// when something cannot be written.
std::string write_bundle(const Bundle& bundle, const ReservedPlace& place, Existing existing);
std::string write_bundle(const Bundle& bundle, const std::filesystem::path& folder,
                         Existing existing = Existing::refuse);

/// manifest.json of a bundle. Throws UserError when there is none or it is malformed.
Manifest read_manifest(const std::filesystem::path& folder);

/// A mesh with faces, rims and fibres. Throws UserError naming the meshes there are when `mesh_name` is none of them.
TetMesh read_mesh(const std::filesystem::path& folder, const std::string& mesh_name);

/// images/labels.nii.gz
LabelVolume read_labels(const std::filesystem::path& folder);

/// recipe.toml as text
std::string read_recipe_text(const std::filesystem::path& folder);

struct Problem {
  std::string file;  ///< path inside the bundle, as listed or found
  std::string what;  ///< "missing", "not in the manifest", "SHA-256 differs" ...
};

/// Every file against the manifest, every path inside the folder, the content id; empty when the bundle is whole.
/// Throws UserError only when `folder` is not a folder.
std::vector<Problem> verify_bundle(const std::filesystem::path& folder);

/// A deterministic .tar.zst of a bundle (sorted entries, no times, owners or modes of this machine), logs left out.
/// Throws UserError when the bundle does not verify, or `archive` cannot be written or has another ending (.tzst may
/// be).
void pack_bundle(const std::filesystem::path& folder, const std::filesystem::path& archive);

/// Unpacks into `folder` (which must not exist) and verifies; refuses entries that leave the folder, links, devices.
/// Throws UserError naming the archive's entry; nothing is left at `folder` then.
void unpack_bundle(const std::filesystem::path& archive, const std::filesystem::path& folder);

/// Hex digest of a file's content or of a text. Throws UserError when the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);
std::string sha256_of_text(const std::string& text);

}  // namespace heartgen::exporters
